// Sparse grid around a level of phi: nodes with exact phi, and the cells that the level crosses.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "front/key_map.h"
#include "phront/distance_field.h"
#include "phront/progress.h"
#include "phront/status.h"
#include "phront/surface_distance.h"

namespace phront {

struct GridNode {
  double phi = 0;
  Vec3 foot = Vec3::Zero();
  Index triangle = kNone;  ///< kNone: phi has no sign here (beyond the border of an open shell)
};

/// A cube with phi at its corners. Corner c: bit 0 is +x, bit 1 +y, bit 2 +z.
struct GridCell {
  /// Of a quiet cell: what a search for thin features in it found.
  enum class Search : std::uint8_t { Pending, Nothing, Feature };
  GridIndex lower{};
  std::int32_t size = 1;  ///< a power of two, in steps of the grid index
  std::array<Index, 8> node{};
  std::uint8_t inside = 0;  ///< bit c: phi(corner c) < level
  bool hanging = false;     ///< finer cells lie beside it: some nodes are on its sides, not corners
  Search search = Search::Pending;
};

struct LevelGridOptions {
  double level = 0;
  double spacing = 0;
  std::int64_t maxNodes = 0;
  int threads = 0;
};

/// Everything within about one cell of phi = level, finer where cells were split. Every shortest
/// grid edge that the level crosses has all its cells here (closed input), whatever the signs are:
/// that makes the iso-surface closed. No edge of a cell is crossed twice.
class LevelGrid {
 public:
  /// Cells of one size. Fails with ResourceLimit, Cancelled.
  [[nodiscard]] static Result<LevelGrid> build(const SurfaceDistance& surface,
                                               const LevelGridOptions& options,
                                               const Progress& progress);
  /// Halves some crossed cells, quiet ones with all around them, and those that have to follow. The
  /// grid is of no use where this fails, as build() does.
  [[nodiscard]] Result<void> split(const SurfaceDistance& surface,
                                   std::span<const Index> crossedCells,
                                   std::span<const Index> quietCells,
                                   const LevelGridOptions& options, const Progress& progress);

  [[nodiscard]] double spacing() const { return unit_ * coarse_; }  ///< of unsplit cells
  [[nodiscard]] double finestSpacing() const { return unit_ * finest_; }
  [[nodiscard]] bool canSplit(const GridCell& cell) const { return cell.size > 1; }
  [[nodiscard]] double level() const { return level_; }
  [[nodiscard]] Vec3 position(const GridIndex& node) const {
    return origin_ + unit_ * Vec3(node[0], node[1], node[2]);
  }
  [[nodiscard]] double sideOf(const GridCell& cell) const { return unit_ * cell.size; }
  [[nodiscard]] double length(std::int32_t steps) const { return unit_ * steps; }

  [[nodiscard]] const std::vector<GridNode>& nodes() const { return nodes_; }
  [[nodiscard]] const GridIndex& indexOf(Index node) const {
    return nodeAt_[static_cast<std::size_t>(node)];
  }
  [[nodiscard]] Vec3 positionOf(Index node) const { return position(indexOf(node)); }
  [[nodiscard]] bool inside(Index node) const {
    return nodes_[static_cast<std::size_t>(node)].phi < level_;
  }
  [[nodiscard]] Index findNode(const GridIndex& at) const { return nodeMap_.find(packKey(at)); }

  /// Cells whose boundary the level crosses, sorted by packed coordinates.
  [[nodiscard]] const std::vector<GridCell>& cells() const { return cells_; }
  /// Cells near the level that it does not cross: a thin feature may hide there.
  [[nodiscard]] const std::vector<GridCell>& quietCells() const { return quietCells_; }
  void setSearch(Index quietCell, GridCell::Search found) {
    quietCells_[static_cast<std::size_t>(quietCell)].search = found;
  }
  /// True when x lies in a cell that the level crosses.
  [[nodiscard]] bool crossedAt(const Vec3& x) const;

 private:
  friend class LevelGridBuilder;
  struct Blocks {  ///< of 2^3 unsplit cells, that the nodes were made for
    KeyMap map;
    Index next = 0;
    bool insertNew(std::uint64_t key) {
      if (map.insert(key, next) != next) return false;
      ++next;
      return true;
    }
  };

  /// Number of the cell that holds a place; kNone: there is none. sizeOf(number) gives its size.
  template <class SizeOf>
  [[nodiscard]] Index leafAt(const GridIndex& at, SizeOf&& sizeOf) const {
    for (std::int32_t size = coarse_; size >= finest_; size /= 2) {
      const std::int32_t mask = ~(size - 1);
      const Index found = leafMap_.find(packKey({at[0] & mask, at[1] & mask, at[2] & mask}));
      if (found != kNone && sizeOf(found) == size) return found;
    }
    return kNone;
  }

  double unit_ = 0;          // length of a step of the grid index
  std::int32_t coarse_ = 1;  // steps of an unsplit cell and of the smallest one
  std::int32_t finest_ = 1;
  double level_ = 0;
  double grow_ = 0;  // how far outside of the surface's box the level may lie
  Vec3 origin_ = Vec3::Zero();
  std::vector<GridNode> nodes_;
  std::vector<GridIndex> nodeAt_;
  KeyMap nodeMap_;
  Blocks blocks_;
  std::vector<GridCell> cells_;
  std::vector<GridCell> quietCells_;
  KeyMap leafMap_;  // by lower corner: the crossed cells' numbers, then the quiet ones'
};

/// Calls visit(low, high) with the nodes of the shortest edges that an edge of a cell consists of.
template <class Visit>
void forShortestEdges(const LevelGrid& grid, Index low, Index high, std::int32_t size,
                      std::size_t axis, Visit&& visit) {
  if (size > 1) {
    GridIndex middle = grid.indexOf(low);
    middle[axis] += size / 2;
    if (const Index m = grid.findNode(middle); m != kNone) {
      forShortestEdges(grid, low, m, size / 2, axis, visit);
      forShortestEdges(grid, m, high, size / 2, axis, visit);
      return;
    }
  }
  visit(low, high);
}

/// Calls visit(lower, size) for the smallest sides that a side of a cell, across `axis`, consists
/// of: each belongs to two cells.
template <class Visit>
void forSmallestSides(const LevelGrid& grid, const GridIndex& lower, std::int32_t size,
                      std::size_t axis, bool hanging, Visit&& visit) {
  const std::size_t b = (axis + 1) % 3;
  const std::size_t c = (axis + 2) % 3;
  if (hanging && size > 1) {
    GridIndex centre = lower;
    centre[b] += size / 2;
    centre[c] += size / 2;
    if (grid.findNode(centre) != kNone) {
      for (int quarter = 0; quarter < 4; ++quarter) {
        GridIndex at = lower;
        at[b] += (quarter & 1) * size / 2;
        at[c] += (quarter >> 1) * size / 2;
        forSmallestSides(grid, at, size / 2, axis, true, visit);
      }
      return;
    }
  }
  visit(lower, size);
}

}  // namespace phront
