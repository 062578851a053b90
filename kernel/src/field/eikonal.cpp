// Dense problems on the tiles of the sweeper: nodes of a tile beyond the grid's walls are blocked,
// which is the one-sided difference there.
#include "phront/eikonal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "field/sweeper.h"

namespace phront {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLargest = 1e60;  // of times and steps: far below kFar

tl::unexpected<Error> wrong(std::string message, std::string where) {
  return fail(ErrorCode::InvalidArgument, std::move(message), std::move(where));
}

Result<void> checkInput(const NodeGrid& grid, std::span<const double> known,
                        std::span<const double> speed, const EikonalOptions& options) {
  if (*std::min_element(grid.nodes.begin(), grid.nodes.end()) < 1) {
    return wrong("The grid needs at least one node along each axis.", "nodes");
  }
  if (!(grid.spacing > 0) || !std::isfinite(grid.spacing)) {
    return wrong(
        fmt::format("The grid spacing must be positive and finite, not {:g}.", grid.spacing),
        "spacing");
  }
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
  if (options.threads < 0) return wrong("The number of threads must not be negative.", "threads");
  return {};
}

template <int Dim>
class DenseProblem {
 public:
  DenseProblem(const NodeGrid& grid, std::span<const double> known, std::span<const double> speed)
      : grid_(grid),
        layout_(TileLayout<Dim>::dense(nodesOf(grid))),
        values_(static_cast<std::size_t>(layout_.nodeCount()), kFar),
        steps_(static_cast<std::size_t>(layout_.nodeCount()), kBlocked) {
    forNodes([&](std::size_t node, std::size_t value) {
      if (known[node] < kLargest) {
        values_[value] = known[node];
        return;  // stays blocked
      }
      const double step = speed.empty() ? grid.spacing : grid.spacing / speed[node];
      if (step < kLargest) steps_[value] = step;
    });
  }

  Result<EikonalSolution> solve(const EikonalOptions& options, const Progress& progress) {
    Sweeper<Dim> sweeper(layout_, values_, steps_, options.threads);
    const double tolerance = options.tolerance * grid_.spacing;
    EikonalSolution solution;
    bool second = false;
    for (;;) {
      if (solution.sweeps == options.maxSweeps) {
        return fail(
            ErrorCode::Failed,
            fmt::format("The arrival times still change after {} sweeps.", options.maxSweeps));
      }
      if (!progress.report(0.5)) return fail(ErrorCode::Cancelled, "Cancelled while sweeping.");
      const auto ordering = static_cast<unsigned>(solution.sweeps++ % Sweeper<Dim>::kOrderings);
      if (sweeper.sweep(ordering, tolerance) > 0) continue;
      if (second || options.order == EikonalOrder::First) break;
      second = true;
      sweeper.useSecondOrder();
    }
    solution.times.assign(static_cast<std::size_t>(grid_.nodeCount()), kInfinity);
    forNodes([&](std::size_t node, std::size_t value) {
      if (values_[value] < kFar) solution.times[node] = values_[value];
    });
    return solution;
  }

 private:
  static typename TileLayout<Dim>::Coordinates nodesOf(const NodeGrid& grid) {
    typename TileLayout<Dim>::Coordinates nodes;
    std::copy_n(grid.nodes.begin(), Dim, nodes.begin());
    return nodes;
  }

  /// visit(number in the grid, number of the value) for all nodes of the grid.
  template <class Visit>
  void forNodes(const Visit& visit) const {
    constexpr int kSize = TileLayout<Dim>::kSize;
    for (Index t = 0; t < layout_.tileCount(); ++t) {
      const auto& tile = layout_.coordinates(t);
      for (std::size_t n = 0; n < TileLayout<Dim>::kNodes; ++n) {
        std::array<std::int32_t, 3> node{};
        bool inside = true;
        for (std::size_t axis = 0; axis < Dim; ++axis) {
          const auto place = static_cast<std::int32_t>(n >> (TileLayout<Dim>::kBits * axis));
          node[axis] = tile[axis] * kSize + (place & (kSize - 1));
          inside = inside && node[axis] < grid_.nodes[axis];
        }
        if (!inside) continue;
        visit(static_cast<std::size_t>(grid_.number(node[0], node[1], node[2])),
              static_cast<std::size_t>(t) * TileLayout<Dim>::kNodes + n);
      }
    }
  }

  const NodeGrid& grid_;
  TileLayout<Dim> layout_;
  std::vector<double> values_;
  std::vector<double> steps_;
};

}  // namespace

Result<EikonalSolution> solveEikonal(const NodeGrid& grid, std::span<const double> known,
                                     std::span<const double> speed, const EikonalOptions& options,
                                     const Progress& progress) {
  if (auto ok = checkInput(grid, known, speed, options); !ok) return tl::unexpected(ok.error());
  if (grid.planar()) return DenseProblem<2>(grid, known, speed).solve(options, progress);
  return DenseProblem<3>(grid, known, speed).solve(options, progress);
}

}  // namespace phront
