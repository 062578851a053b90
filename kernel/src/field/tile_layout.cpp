#include "field/tile_layout.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <utility>

namespace phront {

template <int Dim>
TileLayout<Dim>::TileLayout(std::vector<Coordinates> tiles) : tiles_(std::move(tiles)) {
  assert(std::is_sorted(tiles_.begin(), tiles_.end()));
  neighbours_.resize(tiles_.size());
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    for (std::size_t axis = 0; axis < Dim; ++axis) {
      Coordinates before = tiles_[t];
      --before[axis];
      const Index other = find(before);
      neighbours_[t][2 * axis] = other;
      neighbours_[t][2 * axis + 1] = kNone;  // unless the tile there finds this one, later
      if (other != kNone) {
        neighbours_[static_cast<std::size_t>(other)][2 * axis + 1] = static_cast<Index>(t);
      }
    }
  }
}

template <int Dim>
TileLayout<Dim> TileLayout<Dim>::dense(const Coordinates& nodes) {
  Coordinates count;
  for (std::size_t axis = 0; axis < Dim; ++axis) count[axis] = (nodes[axis] + kSize - 1) >> kBits;
  std::vector<Coordinates> tiles;
  Coordinates tile{};
  // Odometer with the last axis fastest: the order that std::array compares in.
  for (;;) {
    tiles.push_back(tile);
    int axis = Dim - 1;
    while (axis >= 0 &&
           ++tile[static_cast<std::size_t>(axis)] == count[static_cast<std::size_t>(axis)]) {
      tile[static_cast<std::size_t>(axis--)] = 0;
    }
    if (axis < 0) break;
  }
  return TileLayout(std::move(tiles));
}

template <int Dim>
Index TileLayout<Dim>::find(const Coordinates& tile) const {
  const auto at = std::lower_bound(tiles_.begin(), tiles_.end(), tile);
  return at == tiles_.end() || *at != tile ? kNone : static_cast<Index>(at - tiles_.begin());
}

template <int Dim>
std::int64_t TileLayout<Dim>::valueOf(const Coordinates& node) const {
  // Arithmetic shift and mask: floor division, also for negative numbers (C++20).
  Coordinates tile;
  std::int64_t inTile = 0;
  for (std::size_t axis = Dim; axis-- > 0;) {
    tile[axis] = node[axis] >> kBits;
    inTile = inTile * kSize + (node[axis] & (kSize - 1));
  }
  const Index number = find(tile);
  return number == kNone ? -1 : static_cast<std::int64_t>(number) * kNodes + inTile;
}

template class TileLayout<2>;
template class TileLayout<3>;

}  // namespace phront
