// The held nodes of a tile beside their values.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "phront/distance_field.h"

namespace phront {

/// visit(number of the node in the tile, its value) in the order of the slots; `values` has one per
/// slot of the field.
template <class Values, class Visit>
void forHeld(const DistanceField::Tile& tile, Values& values, const Visit& visit) {
  auto slot = static_cast<std::size_t>(tile.first);
  for (std::size_t k = 0; k < tile.held.size(); ++k) {
    for (std::uint64_t left = tile.held[k]; left != 0; left &= left - 1)
      visit(static_cast<int>(64 * k) + std::countr_zero(left), values[slot++]);
  }
}

}  // namespace phront
