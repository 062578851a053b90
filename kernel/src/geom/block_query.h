// Closest triangles of the nodes of a cubic block of a grid, sought together.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geom/bvh.h"
#include "geom/closest_on_triangle.h"
#include "phront/types.h"

namespace phront {

/// A block of 8 x 8 x 8 nodes.
struct NodeBlock {
  Vec3 origin = Vec3::Zero();  ///< of the grid
  double spacing = 0;          ///< h > 0
  std::array<std::int32_t, 3> first{};

  /// Of node number n, x fastest.
  [[nodiscard]] Vec3 position(int n) const {
    return origin +
           spacing * Vec3(first[0] + (n & 7), first[1] + (n >> 3 & 7), first[2] + (n >> 6));
  }
};

/// Keeps its memory from block to block.
class BlockQuery {
 public:
  static constexpr int kSize = 8;
  class Visitor;

  /// Number of the node beyond a corner by the bits of `child` along x, y and z.
  static int nodeOf(const std::array<int, 3>& corner, unsigned child) {
    return ((corner[2] + static_cast<int>(child >> 2)) * kSize + corner[1] +
            static_cast<int>(child >> 1 & 1U)) *
               kSize +
           corner[0] + static_cast<int>(child & 1U);
  }

  /// Visits every node not farther than `reach` (infinity: all), and some little farther, with the
  /// few triangles that are nearest up to rounding in single precision: those nearest in truth are
  /// among them, ties included, each once and by increasing id. `leaves` are in the order of the
  /// tree; a triangle may be there several times. `start`, one of the triangles, thought to be near
  /// the block's centre, spares a search; null: none.
  void run(const Bvh& tree, std::span<const QueryTriangle> leaves, const NodeBlock& block,
           double reach, const QueryTriangle* start, Visitor& visitor);

 private:
  /// A triangle in units of the spacing around the block's centre, as linear functions there: good
  /// to single precision of the distance itself, slivers and long triangles included.
  struct Local {
    struct Side {
      std::array<float, 3> outward;  ///< unit, in the plane
      std::array<float, 3> along;    ///< unit
      float across0;                 ///< outward distance of the centre from the side's line
      float start0, end0;            ///< how far the centre lies beyond start and end along it
    };
    std::array<float, 3> normal;
    float height0;
    std::array<Side, 3> sides;
    float margin;  ///< from the sides: nearer, a point does not count as over the face
    Index leaf;
  };
  /// Distances of the centres of eight children to the triangles of a list.
  struct Level {
    std::vector<int> list;       ///< into locals_
    std::vector<float> squared;  ///< eight for each
  };

  bool gather(const Bvh& tree, std::span<const QueryTriangle> leaves, const NodeBlock& block,
              double reach, const QueryTriangle* start);
  static Local localOf(const QueryTriangle& t, const Vec3& centre, double spacing);
  void descend(int level, const std::array<int, 3>& corner, Visitor& visitor);
  void visitNodes(const std::array<int, 3>& corner, const std::array<float, 8>& squaredLimit,
                  Visitor& visitor);
  static void squaredDistances(std::span<const Local> all, std::span<const int> list,
                               const std::array<float, 3>& centre, float step, float* squared,
                               std::array<float, 8>& least);

  float reach_ = 0;
  std::vector<Index> gathered_;
  std::vector<Local> locals_;
  std::array<Level, 3> levels_;   ///< children of 4, 2 and 1 nodes a side
  std::vector<unsigned> nearTo_;  ///< per triangle of the last level: bits of the nodes it may win
  std::vector<Index> candidates_;
};

/// Numbers of nodes in a block are x fastest, candidates are positions in `leaves`.
class BlockQuery::Visitor {
 public:
  virtual ~Visitor() = default;
  virtual void several(int node, std::span<const Index> candidates) = 0;
  /// Nodes with one candidate in common, among the eight from `corner` on: bit c of `which` names
  /// nodeOf(corner, c).
  virtual void sole(const std::array<int, 3>& corner, unsigned which, Index candidate) = 0;
};

}  // namespace phront
