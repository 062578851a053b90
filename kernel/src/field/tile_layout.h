// Where the nodes of a sparse grid lie: which tiles there are and who is next to whom.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "phront/types.h"

namespace phront {

/// Tiles of 8 nodes a side in 2 or 3 dimensions. Values live in flat arrays beside it: node n (x
/// fastest) of tile t has number t * kNodes + n.
template <int Dim>
class TileLayout {
 public:
  static_assert(Dim == 2 || Dim == 3);
  static constexpr int kBits = 3;
  static constexpr int kSize = 1 << kBits;
  static constexpr int kNodes = Dim == 2 ? kSize * kSize : kSize * kSize * kSize;
  using Coordinates = std::array<std::int32_t, Dim>;

  /// `tiles` sorted and unique.
  explicit TileLayout(std::vector<Coordinates> tiles);
  /// The tiles that hold nodes 0 .. nodes-1 of each axis.
  [[nodiscard]] static TileLayout dense(const Coordinates& nodes);

  [[nodiscard]] Index tileCount() const { return static_cast<Index>(tiles_.size()); }
  [[nodiscard]] std::int64_t nodeCount() const {
    return static_cast<std::int64_t>(tiles_.size()) * kNodes;
  }
  [[nodiscard]] const Coordinates& coordinates(Index tile) const {
    return tiles_[static_cast<std::size_t>(tile)];
  }
  /// Number of the tile with these tile coordinates, or kNone.
  [[nodiscard]] Index find(const Coordinates& tile) const;
  /// The tile before (side 0) or after (side 1) this one along an axis, or kNone.
  [[nodiscard]] Index neighbour(Index tile, int axis, int side) const {
    return neighbours_[static_cast<std::size_t>(tile)][static_cast<std::size_t>(2 * axis + side)];
  }
  /// Number of the value of a node, or -1 where no tile is.
  [[nodiscard]] std::int64_t valueOf(const Coordinates& node) const;

 private:
  std::vector<Coordinates> tiles_;
  std::vector<std::array<Index, 2 * Dim>> neighbours_;
};

extern template class TileLayout<2>;
extern template class TileLayout<3>;

}  // namespace phront
