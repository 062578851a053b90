// Fast sweeping over sparse tiles.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "field/godunov_tile.h"
#include "field/tile_layout.h"

namespace phront {

/// Gauss-Seidel sweeps over all tiles. A tile is swept as soon as its upwind neighbours are: tiles
/// on a diagonal run side by side, without a barrier between diagonals. A sweep reads new values
/// upwind and old ones downwind whatever the schedule: the same bits as nested loops over all
/// nodes.
template <int Dim>
class Sweeper {
 public:
  static constexpr int kOrderings = 1 << Dim;

  /// `values` (start values, kFar where unknown) and `steps` (h / speed, kBlocked: stays) have
  /// layout.nodeCount() entries. All must outlive the sweeper.
  Sweeper(const TileLayout<Dim>& layout, std::vector<double>& values,
          const std::vector<double>& steps, int threads);

  /// One sweep. Returns the number of tiles where a value changed by more than `tolerance`; 0: no
  /// other ordering would change more, either.
  std::int64_t sweep(unsigned ordering, double tolerance);

  /// From the next sweep on the second-order scheme. To be called when the first has converged.
  void useSecondOrder();

 private:
  using TileBody = std::function<void(Index tile)>;
  void forTiles(unsigned ordering, const TileBody& body);
  [[nodiscard]] TileView<Dim> view(std::vector<double>& values, Index tile) const;
  [[nodiscard]] bool quiet(Index tile) const;

  const TileLayout<Dim>& layout_;
  std::vector<double>& values_;
  const std::vector<double>& steps_;
  int threads_;
  std::vector<double> first_;  ///< second order: the first-order solution; else empty
  std::unique_ptr<std::atomic<std::uint8_t>[]>
      waitingFor_;                       ///< per tile, upwind neighbours to come
  std::int32_t time_ = 0;                ///< number of this sweep
  std::vector<std::int32_t> changedAt_;  ///< per tile, the last sweep that changed it
  std::vector<std::int32_t> settledAt_;  ///< per tile, the last sweep that did not
};

extern template class Sweeper<2>;
extern template class Sweeper<3>;

}  // namespace phront
