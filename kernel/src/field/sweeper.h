// Fast sweeping over sparse tiles.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <type_traits>
#include <vector>

#include "field/godunov_tile.h"
#include "field/tile_layout.h"

namespace phront {

/// 1 / speed per node of those tiles where it is not 1 everywhere; kBlocked: the node keeps its
/// value.
template <class Real, int Dim>
class TileSteps {
 public:
  static constexpr std::size_t kNodes = TileLayout<Dim>::kNodes;

  explicit TileSteps(Index tiles) : slots_(static_cast<std::size_t>(tiles), kNone) {}

  /// Null where the step is 1.
  [[nodiscard]] const Real* of(Index tile) const {
    const Index slot = slots_[static_cast<std::size_t>(tile)];
    return slot == kNone ? nullptr : values_.data() + static_cast<std::size_t>(slot) * kNodes;
  }
  void set(Index tile, std::size_t node, Real step);

 private:
  std::vector<Index> slots_;
  std::vector<Real> values_;
};

/// Gauss-Seidel sweeps over all tiles. A tile is swept as soon as its upwind neighbours are: tiles
/// on a diagonal run side by side, without a barrier between diagonals. A sweep reads new values
/// upwind and old ones downwind whatever the schedule: the same bits as nested loops over all
/// nodes.
template <class Real, int Dim>
class Sweeper {
 public:
  static constexpr int kOrderings = 1 << Dim;

  /// `values` (start values in units of the spacing, kFar where unknown) has layout.nodeCount()
  /// entries. All must outlive the sweeper.
  Sweeper(const TileLayout<Dim>& layout, std::vector<Real>& values,
          const TileSteps<Real, Dim>& steps, int threads);

  /// One sweep. Returns the number of tiles where a value changed by more than `tolerance`; 0: no
  /// other ordering would change more, either.
  std::int64_t sweep(unsigned ordering, Real tolerance);

  /// From the next sweep on the second-order scheme. To be called when the first has converged.
  void useSecondOrder() requires std::is_same_v<Real, double>;

 private:
  using TileBody = std::function<void(Index tile)>;
  using View = TileView<Real, Dim>;
  void forTiles(unsigned ordering, const TileBody& body);
  [[nodiscard]] View view(std::vector<Real>& values, Index tile) const;
  [[nodiscard]] bool quiet(Index tile) const;
  [[nodiscard]] bool mayLower(Index tile, int axis, int side) const;
  bool sweepOne(Index tile, unsigned ordering, Real tolerance);

  const TileLayout<Dim>& layout_;
  std::vector<Real>& values_;
  const TileSteps<Real, Dim>& steps_;
  int threads_;
  std::vector<Real> first_;  ///< second order: the first-order solution; else empty
  std::unique_ptr<std::atomic<std::uint8_t>[]>
      waitingFor_;                       ///< per tile, upwind neighbours to come
  std::int32_t time_ = 0;                ///< number of this sweep
  std::vector<std::int32_t> changedAt_;  ///< per tile, the last sweep that changed it
  std::vector<std::int32_t> settledAt_;  ///< per tile, the last sweep that did not
};

extern template class TileSteps<float, 2>;
extern template class TileSteps<float, 3>;
extern template class TileSteps<double, 2>;
extern template class TileSteps<double, 3>;
extern template class Sweeper<float, 2>;
extern template class Sweeper<float, 3>;
extern template class Sweeper<double, 2>;
extern template class Sweeper<double, 3>;

}  // namespace phront
