// A tile laid out so that a sweep is vector code.
//
// A node depends on nodes that come before it by one along an axis (already swept) and after it by
// one (not yet). In a slice of the tile, node (p, q), counted in sweeping direction, goes to row
// t = p + q, at the lane of its place along x: nodes of one row do not depend on each other, and
// their neighbours are whole rows too, t - 1 and t + 1 of the slice and t of the slices next to it:
// contiguous loads, no gather. Nodes with p + q + r = L are independent for all slices r (the
// diagonal planes of Detrixhe, Gibou and Min 2013), so rows overlap in the pipeline.
//
// Memory rows go to skewed rows and back by two rounds of blends for each half of four lanes: lane
// l moves by the bits of l, 1 then 2.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "base/lanes.h"
#include "field/godunov_tile.h"

namespace phront {

template <class Real, int Dim>
struct SkewedTile {
  static constexpr std::ptrdiff_t kSize = 8;
  static constexpr std::ptrdiff_t kHalf = kSize / 2;
  static constexpr std::ptrdiff_t kSlices = Dim == 2 ? 1 : kSize;
  /// From row to row: the lane before the first, eight lanes, and room so that halves of four
  /// floats are aligned. The lane after the last is the unused beginning of the next row.
  static constexpr std::ptrdiff_t kRow = 12;
  static constexpr std::ptrdiff_t kFirstLane = 4;
  /// Rows -1 .. 15 and slices -1 .. 8: the halo around the tile.
  static constexpr std::ptrdiff_t kSlice = 17 * kRow;

  using Store = std::array<Real, static_cast<std::size_t>((kSlices + 2) * kSlice + kRow)>;
  alignas(64) Store values;
  alignas(64) Store steps;

  SkewedTile() {
    values.fill(kFar<Real>);
    steps.fill(kBlocked<Real>);
  }

  /// Place of lane 0 of a row.
  static constexpr std::ptrdiff_t at(std::ptrdiff_t row, std::ptrdiff_t slice) {
    return (slice + 1) * kSlice + (row + 1) * kRow + kFirstLane;
  }
};

/// Rows of a slice in memory, in sweeping order.
template <class Real, int Count>
using MemoryRows = std::array<const Real*, Count>;

/// Lanes whose bit is set in `Mask` from `moved`, the others from `kept`.
template <class Real, unsigned Mask>
PHRONT_INLINE Lanes<Real, 4> blend(const Lanes<Real, 4>& kept, const Lanes<Real, 4>& moved) {
  constexpr auto pick = [](int lane) { return (Mask >> lane & 1U) != 0 ? 4 + lane : lane; };
  return __builtin_shufflevector(kept, moved, pick(0), pick(1), pick(2), pick(3));
}

/// Four lanes of `Count` rows from `offset` on, each lane as many rows later in `skewed` as its
/// place in sweeping direction: lane l by l, descending by 3 - l. Room before and after is `fill`.
template <class Real, int Count, bool Descending, std::ptrdiff_t Row>
PHRONT_INLINE void skewHalf(const MemoryRows<Real, Count>& rows, std::ptrdiff_t offset, Real fill,
                            Real* skewed) {
  using Four = Lanes<Real, 4>;
  constexpr unsigned kByOne = Descending ? 0b0101 : 0b1010;
  constexpr unsigned kByTwo = Descending ? 0b0011 : 0b1100;
  const Four none = Four{} + fill;
  Four before = none;
  Four twoBefore = none;
  Four last = none;
  for (int t = 0; t < Count + 3; ++t) {
    const Four row = t < Count ? loadLanes<Four>(rows[static_cast<std::size_t>(t)] + offset) : none;
    const Four byOne = blend<Real, kByOne>(row, last);
    storeLanes(skewed + t * Row, blend<Real, kByTwo>(byOne, twoBefore));
    last = row;
    twoBefore = std::exchange(before, byOne);
  }
}

/// The way back, of eight rows. Returns how far each lane's values fell at most.
template <class Real, bool Descending, std::ptrdiff_t Row>
PHRONT_INLINE Lanes<Real, 4> unskewHalf(const Real* skewed, const std::array<Real*, 8>& rows,
                                        std::ptrdiff_t offset) {
  using Four = Lanes<Real, 4>;
  constexpr unsigned kByOne = Descending ? 0b0101 : 0b1010;
  constexpr unsigned kByTwo = Descending ? 0b0011 : 0b1100;
  Four most{};
  Four byTwo{};
  for (int t = 0; t < 9; ++t) {
    const Four next = blend<Real, kByTwo>(loadLanes<Four>(skewed + t * Row),
                                          loadLanes<Four>(skewed + (t + 2) * Row));
    if (t > 0) {
      Real* row = rows[static_cast<std::size_t>(t - 1)] + offset;
      const Four now = blend<Real, kByOne>(byTwo, next);
      most = maxOf(most, loadLanes<Four>(row) - now);
      storeLanes(row, now);
    }
    byTwo = next;
  }
  return most;
}

}  // namespace phront
