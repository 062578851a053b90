// Dense problems on the tiles of the sweeper: nodes of a tile beyond the grid's walls are blocked,
// which is the one-sided difference there.
#include "phront/eikonal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "field/sweeper.h"

namespace phront {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLargest = 1e13;  // of times and steps, in spacings: far below kFar

tl::unexpected<Error> wrong(std::string message, std::string where) {
  return fail(ErrorCode::InvalidArgument, std::move(message), std::move(where));
}

Result<void> checkInput(const NodeGrid& grid, std::span<const double> known,
                        std::span<const double> speed, const EikonalOptions& options) {
  if (auto ok = checkGrid(grid); !ok) return ok;
  const auto count = static_cast<std::size_t>(grid.nodeCount());
  if (known.size() != count) {
    return wrong(fmt::format("{} known values were given for {} nodes.", known.size(), count),
                 "known");
  }
  if (!speed.empty() && speed.size() != count) {
    return wrong(fmt::format("{} speeds were given for {} nodes.", speed.size(), count), "speed");
  }
  bool any = false;
  for (const double value : known) {
    if (!(value >= 0)) return wrong("Known values must be numbers from 0 on.", "known");
    any = any || value < kInfinity;
  }
  if (!any) return wrong("No value is known: the front has no place to start from.", "known");
  for (const double value : speed) {
    if (!(value >= 0) || value == kInfinity) {
      return wrong("Speeds must be finite numbers from 0 on.", "speed");
    }
  }
  if (!(options.tolerance >= 0)) return wrong("The tolerance must not be negative.", "tolerance");
  if (options.maxSweeps < 1) return wrong("At least one sweep is needed.", "maxSweeps");
  if (options.order == EikonalOrder::Second && options.precision == EikonalPrecision::Single) {
    return wrong("The second order needs double precision.", "precision");
  }
  if (options.threads < 0) return wrong("The number of threads must not be negative.", "threads");
  return {};
}

template <class Real, int Dim>
class DenseProblem {
 public:
  DenseProblem(const NodeGrid& grid, std::span<const double> known, std::span<const double> speed)
      : grid_(grid),
        layout_(TileLayout<Dim>::dense(nodesOf(grid))),
        values_(static_cast<std::size_t>(layout_.nodeCount()), kFar<Real>),
        steps_(layout_.tileCount()) {
    const double perSpacing = 1 / grid.spacing;
    forRows([&](Index tile, std::size_t place, std::int64_t number, std::int32_t count) {
      Real* values = values_.data() + valueOf(tile, place);
      for (std::int32_t i = 0; i < TileLayout<Dim>::kSize; ++i) {
        Real step = kBlocked<Real>;  // beyond the walls
        if (i < count) {
          const auto node = static_cast<std::size_t>(number + i);
          const double time = known[node] * perSpacing;
          if (time < kLargest) {
            values[i] = static_cast<Real>(time);
          } else {
            step = stepOf(speed, node);
          }
        }
        if (step != 1) steps_.set(tile, place + static_cast<std::size_t>(i), step);
      }
    });
  }

  Result<EikonalSolution> solve(const EikonalOptions& options, const Progress& progress) {
    Sweeper<Real, Dim> sweeper(layout_, values_, steps_, options.threads);
    const auto tolerance = static_cast<Real>(options.tolerance);
    EikonalSolution solution;
    bool last = options.order == EikonalOrder::First;
    for (;;) {
      if (solution.sweeps == options.maxSweeps) {
        return fail(
            ErrorCode::Failed,
            fmt::format("The arrival times still change after {} sweeps.", options.maxSweeps));
      }
      if (!progress.report(0.5)) return fail(ErrorCode::Cancelled, "Cancelled while sweeping.");
      const auto ordering =
          static_cast<unsigned>(solution.sweeps++ % Sweeper<Real, Dim>::kOrderings);
      if (sweeper.sweep(ordering, tolerance) > 0) continue;
      if (last) break;
      last = true;
      if constexpr (std::is_same_v<Real, double>) sweeper.useSecondOrder();
    }
    solution.times.resize(static_cast<std::size_t>(grid_.nodeCount()));
    forRows([&](Index tile, std::size_t place, std::int64_t number, std::int32_t count) {
      const Real* values = values_.data() + valueOf(tile, place);
      double* times = solution.times.data() + number;
      for (std::int32_t i = 0; i < count; ++i) {
        times[i] = values[i] < kFar<Real> ? grid_.spacing * values[i] : kInfinity;
      }
    });
    return solution;
  }

 private:
  static typename TileLayout<Dim>::Coordinates nodesOf(const NodeGrid& grid) {
    typename TileLayout<Dim>::Coordinates nodes;
    std::copy_n(grid.nodes.begin(), Dim, nodes.begin());
    return nodes;
  }

  static std::size_t valueOf(Index tile, std::size_t place) {
    return static_cast<std::size_t>(tile) * TileLayout<Dim>::kNodes + place;
  }

  static Real stepOf(std::span<const double> speed, std::size_t node) {
    if (speed.empty()) return 1;
    const double step = 1 / speed[node];
    return step < kLargest ? static_cast<Real>(step) : kBlocked<Real>;
  }

  /// visit(tile, place of the first node in it, its number in the grid, nodes before the wall) for
  /// each row of each tile; no node is before the wall: number 0.
  template <class Visit>
  void forRows(const Visit& visit) const {
    constexpr std::int32_t kSize = TileLayout<Dim>::kSize;
    for (Index t = 0; t < layout_.tileCount(); ++t) {
      const auto& tile = layout_.coordinates(t);
      const std::int32_t i = tile[0] * kSize;
      for (std::int32_t row = 0; row < TileLayout<Dim>::kNodes / kSize; ++row) {
        const std::int32_t j = tile[1] * kSize + row % kSize;
        const std::int32_t k = Dim == 2 ? 0 : tile[Dim - 1] * kSize + row / kSize;
        const bool inside = j < grid_.nodes[1] && k < grid_.nodes[2];
        visit(t, static_cast<std::size_t>(row * kSize), inside ? grid_.number(i, j, k) : 0,
              inside ? std::min(kSize, grid_.nodes[0] - i) : 0);
      }
    }
  }

  const NodeGrid& grid_;
  TileLayout<Dim> layout_;
  std::vector<Real> values_;
  TileSteps<Real, Dim> steps_;
};

template <class Real>
Result<EikonalSolution> solveIn(const NodeGrid& grid, std::span<const double> known,
                                std::span<const double> speed, const EikonalOptions& options,
                                const Progress& progress) {
  if (grid.planar()) return DenseProblem<Real, 2>(grid, known, speed).solve(options, progress);
  return DenseProblem<Real, 3>(grid, known, speed).solve(options, progress);
}

}  // namespace

Result<EikonalSolution> solveEikonal(const NodeGrid& grid, std::span<const double> known,
                                     std::span<const double> speed, const EikonalOptions& options,
                                     const Progress& progress) {
  if (auto ok = checkInput(grid, known, speed, options); !ok) return tl::unexpected(ok.error());
  return options.precision == EikonalPrecision::Single
             ? solveIn<float>(grid, known, speed, options, progress)
             : solveIn<double>(grid, known, speed, options, progress);
}

}  // namespace phront
