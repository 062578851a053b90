// Signed distance on sparse tiles of a Cartesian grid.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <vector>

#include "phront/progress.h"
#include "phront/status.h"
#include "phront/surface_distance.h"

namespace phront {

/// Integer coordinates of a grid node or tile.
using GridIndex = std::array<std::int32_t, 3>;

enum class FieldSolver {
  Exact,    ///< a proven query per node: error is round-off
  Godunov,  ///< exact near the geometry, fast sweeping beyond: the scheme of the thesis
};

/// Which nodes a field must hold and how fine.
struct FieldOptions {
  FieldSolver solver = FieldSolver::Exact;
  double spacing = 0;  ///< h > 0, model units
  double bandMin = 0;  ///< nodes with bandMin <= phi <= bandMax are held
  double bandMax = 0;
  int threads = 0;                      ///< 0: all cores
  std::int64_t maxNodes = 400'000'000;  ///< refuse beyond (ResourceLimit) instead of swapping
  /// Position of node (0,0,0); automatic: lower corner of the surface's box.
  std::optional<Vec3> origin = std::nullopt;
};

class FieldBuilder;

/// phi on 8x8x8-node tiles, allocated only where the band needs them. Node (i,j,k) lies at
/// origin + h (i,j,k); tile (a,b,c) holds nodes 8a..8a+7 and so on, of them those in the band: off
/// the band phi is absent, never guessed. A held node takes 12 bytes, a tile 88. Same input, same
/// bits at any thread count.
class DistanceField {
 public:
  static constexpr int kTileSize = 8;
  static constexpr int kNodesPerTile = kTileSize * kTileSize * kTileSize;

  struct Tile {
    GridIndex coordinates{};              ///< tile coordinates
    std::array<std::uint64_t, 8> held{};  ///< bit j * 8 + i of word k
    std::int64_t first = 0;               ///< slot of the first held node

    /// Where the field keeps a node's values (x fastest, then y, then z), or -1.
    [[nodiscard]] std::int64_t slot(int node) const {
      const auto word = static_cast<std::size_t>(node >> 6);
      const std::uint64_t bit = std::uint64_t{1} << (node & 63);
      if ((held[word] & bit) == 0) return -1;
      std::int64_t before = std::popcount(held[word] & (bit - 1));
      for (std::size_t k = 0; k < word; ++k) before += std::popcount(held[k]);
      return first + before;
    }
  };

  [[nodiscard]] double spacing() const { return spacing_; }
  [[nodiscard]] const Vec3& origin() const { return origin_; }
  /// Sorted by coordinates.
  [[nodiscard]] const std::vector<Tile>& tiles() const { return tiles_; }
  /// Per slot: signed distance; beyond the border of open shells with the sign of the carried face.
  [[nodiscard]] const std::vector<double>& values() const { return phi_; }
  /// Per slot: closest triangle, kNone beyond the border.
  [[nodiscard]] const std::vector<Index>& triangles() const { return triangle_; }
  /// What the field takes, in bytes.
  [[nodiscard]] std::size_t memory() const;

  [[nodiscard]] Vec3 position(const GridIndex& node) const {
    return origin_ + spacing_ * Vec3(node[0], node[1], node[2]);
  }
  [[nodiscard]] GridIndex node(const Tile& tile, int number) const {
    return {tile.coordinates[0] * kTileSize + (number & 7),
            tile.coordinates[1] * kTileSize + (number >> 3 & 7),
            tile.coordinates[2] * kTileSize + (number >> 6)};
  }
  /// visit(node, phi, triangle) for every held node, in the order of the slots.
  template <class Visit>
  void forNodes(const Visit& visit) const {
    std::size_t slot = 0;
    for (const Tile& tile : tiles_) {
      for (int k = 0; k < kTileSize; ++k) {
        for (std::uint64_t left = tile.held[static_cast<std::size_t>(k)]; left != 0;
             left &= left - 1, ++slot) {
          visit(node(tile, 64 * k + std::countr_zero(left)), phi_[slot], triangle_[slot]);
        }
      }
    }
  }
  /// Nodes whose sign was taken from the winding number because signs of neighbours contradicted
  /// each other (closed surfaces that intersect themselves); 0 for a sound mesh.
  [[nodiscard]] std::int64_t signRepairs() const { return signRepairs_; }

  /// Number (into tiles()) of the tile with these tile coordinates, or kNone.
  [[nodiscard]] Index findTile(const GridIndex& tile) const;
  /// phi at a node; empty where it is not held or lies beyond an open border.
  [[nodiscard]] std::optional<double> phi(const GridIndex& node) const;
  /// Trilinear phi at a point; empty when one of the eight nodes is absent. Error O(h^2), O(h) at
  /// kinks.
  [[nodiscard]] std::optional<double> interpolate(const Vec3& x) const;

 private:
  friend class FieldBuilder;
  double spacing_ = 0;
  Vec3 origin_ = Vec3::Zero();
  std::vector<Tile> tiles_;
  std::vector<double> phi_;
  std::vector<Index> triangle_;
  std::int64_t signRepairs_ = 0;
};

/// Signed distance (to the mesh) at all nodes with bandMin <= phi <= bandMax. Exact: error is
/// round-off. Godunov: exact nearer than a cell's diagonal, first order beyond; the triangle of a
/// node is near the closest; closed surfaces only. Signs by topology, audited. On open shells |phi|
/// decides what the band holds, as the sign jumps beyond the border. Fails with InvalidArgument
/// (h <= 0, band empty or NaN), ResourceLimit, Cancelled, Failed.
[[nodiscard]] Result<DistanceField> solveDistanceField(const SurfaceDistance& surface,
                                                       const FieldOptions& options,
                                                       const Progress& progress = {});

}  // namespace phront
