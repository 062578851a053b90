// Exact: a query per node, in space for blocks of nodes at once. Godunov: queries bounded to the
// seeds' reach, a sweep of the magnitudes, and signs that flood the nodes between: both ends of a
// grid edge whose one end is no seed are farther from the geometry than the edge is long.
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
constexpr std::int64_t kGrain = 256;     // nodes per task
constexpr std::int64_t kBlockGrain = 4;  // blocks of nodes per task
constexpr std::int64_t kReports = 50;

/// Signed distance at the nodes not farther than `reach`, infinity elsewhere.
using Values = Result<std::vector<double>>;

/// work(begin, end) over `count` pieces, side by side. Cancelled or not.
template <class Work>
Result<void> forPieces(std::int64_t count, std::int64_t grain, int threads,
                       const Progress& progress, const Work& work) {
  const std::int64_t chunk = std::max<std::int64_t>(16 * grain, count / kReports);
  for (std::int64_t from = 0; from < count; from += chunk) {
    if (!progress.report(static_cast<double>(from) / static_cast<double>(count))) {
      return fail(ErrorCode::Cancelled, "Cancelled while distances were computed.");
    }
    parallelFor(std::min(chunk, count - from), threads, grain,
                [&](std::int64_t begin, std::int64_t end) { work(from + begin, from + end); });
  }
  return {};
}

Values exactValues(const NodeGrid& grid, const CurveDistance& curves, double reach, int threads,
                   const Progress& progress) {
  std::vector<double> phi(static_cast<std::size_t>(grid.nodeCount()));
  const auto done = forPieces(
      grid.nodeCount(), kGrain, threads, progress, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t n = begin; n < end; ++n) {
          const Vec3 x = grid.position(static_cast<std::int32_t>(n % grid.nodes[0]),
                                       static_cast<std::int32_t>(n / grid.nodes[0]));
          phi[static_cast<std::size_t>(n)] = curves.foot(x.head<2>(), reach).phi();
        }
      });
  if (!done) return tl::unexpected(done.error());
  return phi;
}

Values exactValues(const NodeGrid& grid, const SurfaceDistance& surface, double reach, int threads,
                   const Progress& progress) {
  constexpr std::int32_t kSize = 8;
  std::vector<double> phi(static_cast<std::size_t>(grid.nodeCount()), kInfinity);
  std::array<std::int64_t, 3> blocks{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    blocks[axis] = (grid.nodes[axis] + kSize - 1) / kSize;
  const auto fill = [&](std::int64_t block) {
    const std::array<std::int32_t, 3> first{
        static_cast<std::int32_t>(block % blocks[0]) * kSize,
        static_cast<std::int32_t>(block / blocks[0] % blocks[1]) * kSize,
        static_cast<std::int32_t>(block / blocks[0] / blocks[1]) * kSize};
    const BlockPhi found = surface.phiOnBlock(grid.origin, grid.spacing, first, reach);
    for (std::int32_t n = 0; n < kSize * kSize * kSize; ++n) {
      const auto at = static_cast<std::size_t>(n);
      if ((found.held[at >> 6] >> (at & 63) & 1U) == 0) continue;
      const std::int32_t i = first[0] + (n & 7);
      const std::int32_t j = first[1] + (n >> 3 & 7);
      const std::int32_t k = first[2] + (n >> 6);
      if (i >= grid.nodes[0] || j >= grid.nodes[1] || k >= grid.nodes[2]) continue;
      phi[static_cast<std::size_t>(grid.number(i, j, k))] = found.phi[at];
    }
  };
  const auto done = forPieces(blocks[0] * blocks[1] * blocks[2], kBlockGrain, threads, progress,
                              [&](std::int64_t begin, std::int64_t end) {
                                for (std::int64_t b = begin; b < end; ++b) fill(b);
                              });
  if (!done) return tl::unexpected(done.error());
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

bool isWatertight(const CurveDistance& curves) { return curves.closed(); }
bool isWatertight(const SurfaceDistance& surface) { return surface.watertight(); }

template <class Geometry>
Result<GridField> solve(const NodeGrid& grid, const Geometry& geometry,
                        const GridFieldOptions& options, const Progress& progress) {
  if (auto ok = checkGrid(grid); !ok) return tl::unexpected(ok.error());
  if (options.threads < 0) {
    return fail(ErrorCode::InvalidArgument, "The number of threads must not be negative.",
                "threads");
  }
  GridField field;
  if (options.solver == FieldSolver::Exact) {
    auto phi = exactValues(grid, geometry, kInfinity, options.threads, progress);
    if (!phi) return tl::unexpected(phi.error());
    field.phi = std::move(*phi);
    return field;
  }
  const double cell = std::sqrt(grid.planar() ? 2.0 : 3.0) * grid.spacing;
  const double reach = options.order == EikonalOrder::First ? cell : cell + grid.spacing;
  const auto exact =
      exactValues(grid, geometry, reach, options.threads, progress.part(0, 0.5, "seed"));
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
  if (isWatertight(geometry)) {
    spreadSigns(grid, *exact, field.phi);
    return field;
  }
  // Beyond the border of open geometry the sign jumps between nodes: each is asked for.
  const auto sided = exactValues(grid, geometry, kInfinity, options.threads, {});
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
  return solve(grid, curves, options, progress);
}

Result<GridField> solveGridField(const NodeGrid& grid, const SurfaceDistance& surface,
                                 const GridFieldOptions& options, const Progress& progress) {
  if (grid.planar()) {
    return fail(ErrorCode::InvalidArgument, "Surfaces need a grid in space.", "nodes");
  }
  return solve(grid, surface, options, progress);
}

}  // namespace phront
