// Exact: one query per node. Godunov: queries bounded to the seeds' reach, a sweep of the
// magnitudes, and signs that flood the nodes between: both ends of a grid edge whose one end is no
// seed are farther from the geometry than the edge is long.
#include "phront/grid_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "base/parallel.h"

namespace phront {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::int64_t kGrain = 256;  // nodes per task
constexpr std::int64_t kReports = 50;

/// Exact signed distance at the nodes nearer than `reach`, infinity elsewhere. The geometry's foot
/// is `footOf(x, reach)`.
template <class FootOf>
Result<std::vector<double>> exactValues(const NodeGrid& grid, const FootOf& footOf, double reach,
                                        int threads, const Progress& progress) {
  const std::int64_t count = grid.nodeCount();
  std::vector<double> phi(static_cast<std::size_t>(count));
  const std::int64_t chunk = std::max<std::int64_t>(16 * kGrain, count / kReports);
  for (std::int64_t from = 0; from < count; from += chunk) {
    if (!progress.report(static_cast<double>(from) / static_cast<double>(count))) {
      return fail(ErrorCode::Cancelled, "Cancelled while distances were computed.");
    }
    parallelFor(std::min(chunk, count - from), threads, kGrain,
                [&](std::int64_t begin, std::int64_t end) {
                  for (std::int64_t n = from + begin; n < from + end; ++n) {
                    const std::int64_t row = n / grid.nodes[0];
                    const Vec3 x = grid.position(static_cast<std::int32_t>(n % grid.nodes[0]),
                                                 static_cast<std::int32_t>(row % grid.nodes[1]),
                                                 static_cast<std::int32_t>(row / grid.nodes[1]));
                    phi[static_cast<std::size_t>(n)] = footOf(x, reach).phi();
                  }
                });
  }
  return phi;
}

/// Gives each node without a sign (infinity in `exact`) that of a neighbour, from the seeds on.
void spreadSigns(const NodeGrid& grid, const std::vector<double>& exact, std::vector<double>& phi) {
  std::vector<bool> done(exact.size());
  std::vector<std::int64_t> front;
  for (std::size_t n = 0; n < exact.size(); ++n) {
    done[n] = exact[n] != kInfinity;
    if (done[n]) front.push_back(static_cast<std::int64_t>(n));
  }
  const std::array<std::int64_t, 3> stride{
      1, grid.nodes[0], static_cast<std::int64_t>(grid.nodes[0]) * grid.nodes[1]};
  while (!front.empty()) {
    const std::int64_t n = front.back();
    front.pop_back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t place = n / stride[axis] % grid.nodes[axis];
      for (const std::int64_t step : {-1, 1}) {
        if (place + step < 0 || place + step >= grid.nodes[axis]) continue;
        const std::int64_t next = n + step * stride[axis];
        if (done[static_cast<std::size_t>(next)]) continue;
        done[static_cast<std::size_t>(next)] = true;
        double& value = phi[static_cast<std::size_t>(next)];
        value = std::copysign(value, phi[static_cast<std::size_t>(n)]);
        front.push_back(next);
      }
    }
  }
}

template <class FootOf>
Result<GridField> solve(const NodeGrid& grid, const FootOf& footOf, bool closed,
                        const GridFieldOptions& options, const Progress& progress) {
  if (auto ok = checkGrid(grid); !ok) return tl::unexpected(ok.error());
  if (options.threads < 0) {
    return fail(ErrorCode::InvalidArgument, "The number of threads must not be negative.",
                "threads");
  }
  GridField field;
  if (options.solver == FieldSolver::Exact) {
    auto phi = exactValues(grid, footOf, kInfinity, options.threads, progress);
    if (!phi) return tl::unexpected(phi.error());
    field.phi = std::move(*phi);
    return field;
  }
  const double cell = std::sqrt(grid.planar() ? 2.0 : 3.0) * grid.spacing;
  const double reach = options.order == EikonalOrder::First ? cell : cell + grid.spacing;
  const auto exact =
      exactValues(grid, footOf, reach, options.threads, progress.part(0, 0.5, "seed"));
  if (!exact) return tl::unexpected(exact.error());
  std::vector<double> known;
  known.reserve(exact->size());
  field.seed.reserve(exact->size());
  for (const double phi : *exact) {
    known.push_back(std::abs(phi));
    field.seed.push_back(phi != kInfinity);
  }
  auto solved = solveEikonal(grid, known, {}, {.order = options.order, .threads = options.threads},
                             progress.part(0.5, 1, "sweep"));
  if (!solved) return tl::unexpected(solved.error());
  field.sweeps = solved->sweeps;
  field.phi = std::move(solved->times);
  for (std::size_t n = 0; n < exact->size(); ++n) {
    if (field.seed[n]) field.phi[n] = (*exact)[n];
  }
  if (closed) {
    spreadSigns(grid, *exact, field.phi);
    return field;
  }
  // Beyond the border of open geometry the sign jumps between nodes: each is asked for.
  const auto sided = exactValues(grid, footOf, kInfinity, options.threads, {});
  if (!sided) return tl::unexpected(sided.error());
  for (std::size_t n = 0; n < sided->size(); ++n) {
    field.phi[n] = std::copysign(field.phi[n], (*sided)[n]);
  }
  return field;
}

}  // namespace

Result<GridField> solveGridField(const NodeGrid& grid, const CurveDistance& curves,
                                 const GridFieldOptions& options, const Progress& progress) {
  if (!grid.planar()) {
    return fail(ErrorCode::InvalidArgument, "Curves need a grid in the plane.", "nodes");
  }
  const auto foot = [&](const Vec3& x, double reach) { return curves.foot(x.head<2>(), reach); };
  return solve(grid, foot, curves.closed(), options, progress);
}

Result<GridField> solveGridField(const NodeGrid& grid, const SurfaceDistance& surface,
                                 const GridFieldOptions& options, const Progress& progress) {
  if (grid.planar()) {
    return fail(ErrorCode::InvalidArgument, "Surfaces need a grid in space.", "nodes");
  }
  const auto foot = [&](const Vec3& x, double reach) { return surface.foot(x, reach); };
  return solve(grid, foot, surface.closed(), options, progress);
}

}  // namespace phront
