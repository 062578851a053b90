// Fast sweeping (Zhao 2005): 2^n orderings, each follows all characteristics of one quadrant or
// octant, so that a constant speed needs one round and little more. Tiles wait for their upwind
// neighbours only (a task graph in place of the diagonal planes of Detrixhe, Gibou and Min 2013,
// whose barriers collapse on a busy machine). A tile that a sweep left as it was is skipped until
// it changes or a neighbour brings it a smaller value (locking, Bak, McLaughlin and Renzi 2010, by
// tiles): most of the work of a round.
#include "field/sweeper.h"

#include <algorithm>
#include <cstddef>

#include "base/parallel.h"
#include "field/second_order_tile.h"

namespace phront {

template <class Real, int Dim>
void TileSteps<Real, Dim>::set(Index tile, std::size_t node, Real step) {
  Index& slot = slots_[static_cast<std::size_t>(tile)];
  if (slot == kNone) {
    slot = static_cast<Index>(values_.size() / kNodes);
    values_.resize(values_.size() + kNodes, 1);
  }
  values_[static_cast<std::size_t>(slot) * kNodes + node] = step;
}

template <class Real, int Dim>
Sweeper<Real, Dim>::Sweeper(const TileLayout<Dim>& layout, std::vector<Real>& values,
                            const TileSteps<Real, Dim>& steps, int threads)
    : layout_(layout),
      values_(values),
      steps_(steps),
      threads_(threads),
      waitingFor_(new std::atomic<std::uint8_t>[static_cast<std::size_t>(layout.tileCount())]),
      changedAt_(static_cast<std::size_t>(layout.tileCount()), -1),
      settledAt_(static_cast<std::size_t>(layout.tileCount()), 0) {
  // Settled from the start: tiles that know nothing.
  for (std::size_t t = 0; t < changedAt_.size(); ++t) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(t * TileLayout<Dim>::kNodes);
    const bool empty = std::all_of(first, first + TileLayout<Dim>::kNodes,
                                   [](Real value) { return value == kFar<Real>; });
    if (!empty) changedAt_[t] = 0;
  }
}

template <class Real, int Dim>
void Sweeper<Real, Dim>::forTiles(unsigned ordering, const TileBody& body) {
  const auto upwind = [&](int axis) { return static_cast<int>(ordering >> axis & 1U); };
  std::vector<Index> first;
  for (Index t = 0; t < layout_.tileCount(); ++t) {
    std::uint8_t count = 0;
    for (int axis = 0; axis < Dim; ++axis) {
      if (layout_.neighbour(t, axis, upwind(axis)) != kNone) ++count;
    }
    waitingFor_[static_cast<std::size_t>(t)].store(count, std::memory_order_relaxed);
    if (count == 0) first.push_back(t);
  }
  parallelWorklist(first, threads_, [&](Index tile, const AddItem& add) {
    body(tile);
    for (int axis = 0; axis < Dim; ++axis) {
      const Index next = layout_.neighbour(tile, axis, 1 - upwind(axis));
      if (next == kNone) continue;
      if (waitingFor_[static_cast<std::size_t>(next)].fetch_sub(1, std::memory_order_acq_rel) ==
          1) {
        add(next);
      }
    }
  });
}

template <class Real, int Dim>
TileView<Real, Dim> Sweeper<Real, Dim>::view(std::vector<Real>& values, Index tile) const {
  constexpr std::size_t kNodes = TileLayout<Dim>::kNodes;
  View result;
  result.values = values.data() + static_cast<std::size_t>(tile) * kNodes;
  result.steps = steps_.of(tile);
  for (int axis = 0; axis < Dim; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const Index other = layout_.neighbour(tile, axis, side);
      result.neighbours[static_cast<std::size_t>(2 * axis + side)] =
          other == kNone ? nullptr : values.data() + static_cast<std::size_t>(other) * kNodes;
    }
  }
  return result;
}

// Neighbours upwind are done with this sweep, those downwind have not begun: no race.
template <class Real, int Dim>
bool Sweeper<Real, Dim>::quiet(Index tile) const {
  const auto changed = [&](Index t) { return changedAt_[static_cast<std::size_t>(t)]; };
  const std::int32_t settled = settledAt_[static_cast<std::size_t>(tile)];
  if (changed(tile) >= settled) return false;
  for (int axis = 0; axis < Dim; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const Index other = layout_.neighbour(tile, axis, side);
      if (other != kNone && changed(other) >= settled && mayLower(tile, axis, side)) return false;
    }
  }
  return true;
}

// A node takes only smaller neighbours in.
template <class Real, int Dim>
bool Sweeper<Real, Dim>::mayLower(Index tile, int axis, int side) const {
  if (!first_.empty()) return true;  // second order: values rise, too
  constexpr std::size_t kNodes = TileLayout<Dim>::kNodes;
  constexpr std::size_t kLast = TileLayout<Dim>::kSize - 1;
  const Real* own = values_.data() + static_cast<std::size_t>(tile) * kNodes;
  const Index neighbour = layout_.neighbour(tile, axis, side);
  const Real* other = values_.data() + static_cast<std::size_t>(neighbour) * kNodes;
  const std::size_t stride = std::size_t{1} << (TileLayout<Dim>::kBits * axis);
  const std::size_t here = side == 0 ? 0 : kLast * stride;
  const std::size_t there = kLast * stride - here;
  for (std::size_t block = 0; block < kNodes; block += (kLast + 1) * stride) {
    for (std::size_t n = block; n < block + stride; ++n) {
      if (other[n + there] < own[n + here]) return true;
    }
  }
  return false;
}

template <class Real, int Dim>
bool Sweeper<Real, Dim>::sweepOne(Index tile, unsigned ordering, Real tolerance) {
  if constexpr (std::is_same_v<Real, double>) {
    if (!first_.empty())
      return refineTile(view(values_, tile), view(first_, tile), ordering, tolerance);
  }
  return sweepTile(view(values_, tile), ordering, tolerance);
}

template <class Real, int Dim>
std::int64_t Sweeper<Real, Dim>::sweep(unsigned ordering, Real tolerance) {
  ++time_;
  std::atomic<std::int64_t> changed = 0;
  forTiles(ordering, [&](Index tile) {
    if (quiet(tile)) return;
    const auto t = static_cast<std::size_t>(tile);
    if (sweepOne(tile, ordering, tolerance)) {
      changedAt_[t] = time_;
      changed.fetch_add(1, std::memory_order_relaxed);
    } else {
      settledAt_[t] = time_;
    }
  });
  return changed;
}

template <class Real, int Dim>
void Sweeper<Real, Dim>::useSecondOrder() requires std::is_same_v<Real, double> {
  first_ = values_;
  std::fill(settledAt_.begin(), settledAt_.end(), -1);
}

template class TileSteps<float, 2>;
template class TileSteps<float, 3>;
template class TileSteps<double, 2>;
template class TileSteps<double, 3>;
template class Sweeper<float, 2>;
template class Sweeper<float, 3>;
template class Sweeper<double, 2>;
template class Sweeper<double, 3>;

}  // namespace phront
