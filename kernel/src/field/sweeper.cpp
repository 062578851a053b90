// Fast sweeping (Zhao 2005): 2^n orderings, each follows all characteristics of one quadrant or
// octant, so that a constant speed needs one round and little more. Tiles wait for their upwind
// neighbours only (a task graph in place of the diagonal planes of Detrixhe, Gibou and Min 2013,
// whose barriers collapse on a busy machine). A tile that a sweep left as it was is skipped until
// it or a neighbour changes (locking, Bak, McLaughlin and Renzi 2010, by tiles).
#include "field/sweeper.h"

#include <algorithm>
#include <cstddef>

#include "base/parallel.h"
#include "field/second_order_tile.h"

namespace phront {

template <int Dim>
Sweeper<Dim>::Sweeper(const TileLayout<Dim>& layout, std::vector<double>& values,
                      const std::vector<double>& steps, int threads)
    : layout_(layout),
      values_(values),
      steps_(steps),
      threads_(threads),
      waitingFor_(new std::atomic<std::uint8_t>[static_cast<std::size_t>(layout.tileCount())]),
      changedAt_(static_cast<std::size_t>(layout.tileCount()), 0),
      settledAt_(static_cast<std::size_t>(layout.tileCount()), -1) {}

template <int Dim>
void Sweeper<Dim>::forTiles(unsigned ordering, const TileBody& body) {
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

template <int Dim>
TileView<Dim> Sweeper<Dim>::view(std::vector<double>& values, Index tile) const {
  constexpr std::size_t kNodes = TileLayout<Dim>::kNodes;
  TileView<Dim> result;
  result.values = values.data() + static_cast<std::size_t>(tile) * kNodes;
  result.steps = steps_.data() + static_cast<std::size_t>(tile) * kNodes;
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
template <int Dim>
bool Sweeper<Dim>::quiet(Index tile) const {
  const auto changed = [&](Index t) { return changedAt_[static_cast<std::size_t>(t)]; };
  const std::int32_t settled = settledAt_[static_cast<std::size_t>(tile)];
  if (changed(tile) >= settled) return false;
  for (int axis = 0; axis < Dim; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const Index other = layout_.neighbour(tile, axis, side);
      if (other != kNone && changed(other) >= settled) return false;
    }
  }
  return true;
}

template <int Dim>
std::int64_t Sweeper<Dim>::sweep(unsigned ordering, double tolerance) {
  ++time_;
  std::atomic<std::int64_t> changed = 0;
  forTiles(ordering, [&](Index tile) {
    if (quiet(tile)) return;
    const auto t = static_cast<std::size_t>(tile);
    const bool moved =
        first_.empty() ? sweepTile(view(values_, tile), ordering, tolerance)
                       : refineTile(view(values_, tile), view(first_, tile), ordering, tolerance);
    if (moved) {
      changedAt_[t] = time_;
      changed.fetch_add(1, std::memory_order_relaxed);
    } else {
      settledAt_[t] = time_;
    }
  });
  return changed;
}

template <int Dim>
void Sweeper<Dim>::useSecondOrder() {
  first_ = values_;
  std::fill(settledAt_.begin(), settledAt_.end(), -1);
}

template class Sweeper<2>;
template class Sweeper<3>;

}  // namespace phront
