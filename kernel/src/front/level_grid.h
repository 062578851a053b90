// Sparse grid around a level of phi: nodes with exact phi, and the cells that the level crosses.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "phront/distance_field.h"
#include "phront/progress.h"
#include "phront/status.h"
#include "phront/surface_distance.h"

namespace phront {

/// Open-addressing map from packed grid coordinates to a number; no iteration, so no order.
class KeyMap {
 public:
  KeyMap();
  /// Number stored for the key, or kNone.
  [[nodiscard]] Index find(std::uint64_t key) const;
  /// Stores `value` unless the key is there; returns the stored number.
  Index insert(std::uint64_t key, Index value);

 private:
  void grow();
  std::vector<std::uint64_t> keys_;
  std::vector<Index> values_;
  std::size_t used_ = 0;
};

/// Grid coordinates (each within -2^20 .. 2^20 - 1) in one number that sorts by z, y, x.
[[nodiscard]] std::uint64_t packKey(const GridIndex& index);
[[nodiscard]] GridIndex unpackKey(std::uint64_t key);

struct GridNode {
  double phi = 0;
  Vec3 foot = Vec3::Zero();
  Index triangle = kNone;  ///< kNone: phi has no sign here (beyond the border of an open shell)
};

/// A cell whose corners differ in sign, all with phi. Corner c: bit 0 is +x, bit 1 +y, bit 2 +z.
struct GridCell {
  GridIndex lower{};
  std::array<Index, 8> node{};
  std::uint8_t inside = 0;  ///< bit c: phi(corner c) < level
};

struct LevelGridOptions {
  double level = 0;
  double spacing = 0;
  std::int64_t maxNodes = 0;
  int threads = 0;
};

/// Everything within about one cell of phi = level. Every grid edge that the level crosses has all
/// its four cells here (closed input), whatever the signs are: that makes the iso-surface closed.
class LevelGrid {
 public:
  [[nodiscard]] static Result<LevelGrid> build(const SurfaceDistance& surface,
                                               const LevelGridOptions& options,
                                               const Progress& progress);

  [[nodiscard]] double spacing() const { return spacing_; }
  [[nodiscard]] double level() const { return level_; }
  [[nodiscard]] Vec3 position(const GridIndex& node) const {
    return origin_ + spacing_ * Vec3(node[0], node[1], node[2]);
  }
  /// Lower node of the cell that holds a point.
  [[nodiscard]] GridIndex cellAt(const Vec3& x) const {
    const Vec3 at = (x - origin_) / spacing_;
    return {static_cast<std::int32_t>(std::floor(at[0])),
            static_cast<std::int32_t>(std::floor(at[1])),
            static_cast<std::int32_t>(std::floor(at[2]))};
  }
  [[nodiscard]] const std::vector<GridNode>& nodes() const { return nodes_; }
  [[nodiscard]] Vec3 positionOf(Index node) const {
    return position(nodeAt_[static_cast<std::size_t>(node)]);
  }
  /// Cells with a change of sign, sorted by packed coordinates.
  [[nodiscard]] const std::vector<GridCell>& cells() const { return cells_; }
  [[nodiscard]] Index findCell(const GridIndex& lower) const {
    return cellMap_.find(packKey(lower));
  }
  /// Cells near the level whose corners all agree in sign: a thin feature may hide there.
  [[nodiscard]] const std::vector<GridCell>& quietCells() const { return quietCells_; }

 private:
  friend class LevelGridBuilder;
  double spacing_ = 0;
  double level_ = 0;
  Vec3 origin_ = Vec3::Zero();
  std::vector<GridNode> nodes_;
  std::vector<GridIndex> nodeAt_;
  std::vector<GridCell> cells_;
  std::vector<GridCell> quietCells_;
  KeyMap cellMap_;
};

}  // namespace phront
