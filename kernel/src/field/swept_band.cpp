// Exact values at all nodes of the cells that the surface may touch, a sweep of the magnitudes on
// the sparse tiles between there and the far end of the band, and signs and triangles that flood
// from the exact nodes: both ends of a grid edge whose one end is not exact are farther from the
// surface than the edge is long. Tiles that the band does not need on its way are walls, where
// differences are one-sided; the way to a node of the band leads through the band.
#include "field/swept_band.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "field/sweeper.h"

namespace phront {
namespace {

using Layout = TileLayout<3>;

constexpr std::int64_t kGrain = 4;  // tiles per task
constexpr int kMaxSweeps = 1000;

std::size_t index(std::int64_t i) { return static_cast<std::size_t>(i); }

Layout layoutOf(const std::vector<TileSeed>& seeds) {
  std::vector<GridIndex> tiles;
  for (const TileSeed& seed : seeds) tiles.push_back(seed.coordinates);
  return Layout(std::move(tiles));
}

class BandSweep {
 public:
  BandSweep(const SurfaceDistance& surface, const BandGrid& grid,
            const std::vector<TileSeed>& seeds)
      : surface_(surface),
        grid_(grid),
        layout_(layoutOf(seeds)),
        times_(index(layout_.nodeCount()), kFar<double>),
        steps_(layout_.tileCount()),
        triangle_(times_.size(), kNone),
        negative_(times_.size(), 0) {}

  void seed() {
    const double reach = std::sqrt(3.0) * grid_.spacing;
    std::vector<std::array<std::uint64_t, 8>> exact(index(layout_.tileCount()));
    parallelFor(layout_.tileCount(), grid_.threads, kGrain,
                [&](std::int64_t begin, std::int64_t end) {
                  for (std::int64_t t = begin; t < end; ++t) {
                    const GridIndex& c = layout_.coordinates(static_cast<Index>(t));
                    const BlockPhi block = surface_.phiOnBlock(
                        grid_.origin, grid_.spacing, {8 * c[0], 8 * c[1], 8 * c[2]}, reach);
                    exact[index(t)] = block.held;
                    for (std::size_t n = 0; n < Layout::kNodes; ++n) {
                      if ((block.held[n >> 6] >> (n & 63) & 1U) == 0) continue;
                      const std::size_t at = index(t) * Layout::kNodes + n;
                      times_[at] = std::abs(block.phi[n]) / grid_.spacing;
                      negative_[at] = block.phi[n] < 0 ? 1 : 0;
                      triangle_[at] = block.triangle[n];
                    }
                  }
                });
    for (Index t = 0; t < layout_.tileCount(); ++t) {
      for (std::size_t n = 0; n < Layout::kNodes; ++n) {
        if ((exact[index(t)][n >> 6] >> (n & 63) & 1U) != 0) steps_.set(t, n, kBlocked<double>);
      }
    }
  }

  Result<void> sweep(const Progress& progress) {
    constexpr double kTolerance = 1e-9;  // spacings
    Sweeper<double, 3> sweeper(layout_, times_, steps_, grid_.threads);
    for (int sweeps = 0; sweeps < kMaxSweeps; ++sweeps) {
      if (!progress.report(0.5)) return fail(ErrorCode::Cancelled, "Cancelled while sweeping.");
      if (sweeper.sweep(static_cast<unsigned>(sweeps) % 8, kTolerance) == 0) return {};
    }
    return fail(ErrorCode::Failed, "The distances still change after a thousand sweeps.");
  }

  /// Breadth first: the triangle that a node gets is near its closest.
  void spread() {
    std::vector<std::int64_t> queue;
    for (std::size_t n = 0; n < triangle_.size(); ++n) {
      if (triangle_[n] != kNone) queue.push_back(static_cast<std::int64_t>(n));
    }
    for (std::size_t i = 0; i < queue.size(); ++i) {
      const std::size_t from = index(queue[i]);
      forNeighbours(queue[i], [&](std::int64_t next) {
        const std::size_t to = index(next);
        if (triangle_[to] != kNone || times_[to] >= kFar<double>) return;
        triangle_[to] = triangle_[from];
        negative_[to] = negative_[from];
        queue.push_back(next);
      });
    }
  }

  void handOver(const TakeTile& take) const {
    for (Index t = 0; t < layout_.tileCount(); ++t) take(layout_.coordinates(t), blockOf(t));
  }

 private:
  [[nodiscard]] BlockPhi blockOf(Index t) const {
    BlockPhi block;
    for (std::size_t n = 0; n < Layout::kNodes; ++n) {
      const std::size_t at = index(t) * Layout::kNodes + n;
      if (triangle_[at] == kNone) continue;
      const double phi = (negative_[at] != 0 ? -1 : 1) * grid_.spacing * times_[at];
      if (phi < grid_.bandMin || phi > grid_.bandMax) continue;
      block.held[n >> 6] |= std::uint64_t{1} << (n & 63);
      block.phi[n] = phi;
      block.triangle[n] = triangle_[at];
    }
    return block;
  }

  template <class Visit>
  void forNeighbours(std::int64_t node, const Visit& visit) const {
    const auto tile = static_cast<Index>(node / Layout::kNodes);
    const std::int64_t place = node % Layout::kNodes;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t stride = std::int64_t{1} << (Layout::kBits * axis);
      const std::int64_t last = (Layout::kSize - 1) * stride;
      const std::int64_t onAxis = place & last;
      if (onAxis > 0) visit(node - stride);
      if (onAxis < last) visit(node + stride);
      if (onAxis != 0 && onAxis != last) continue;
      const Index other = layout_.neighbour(tile, axis, onAxis == 0 ? 0 : 1);
      if (other != kNone) visit(static_cast<std::int64_t>(other) * Layout::kNodes + (place ^ last));
    }
  }

  const SurfaceDistance& surface_;
  const BandGrid& grid_;
  Layout layout_;
  std::vector<double> times_;  ///< in spacings
  TileSteps<double, 3> steps_;
  std::vector<Index> triangle_;
  std::vector<char> negative_;
};

}  // namespace

Result<void> sweepBand(const SurfaceDistance& surface, const BandGrid& grid, const TakeTile& take,
                       const Progress& progress) {
  BandGrid whole = grid;  // fronts start at the surface
  whole.bandMin = std::min(grid.bandMin, 0.0);
  whole.bandMax = std::max(grid.bandMax, 0.0);
  const auto seeds = tilesOfBand(surface, whole, progress.part(0, 0.2, "tiles"));
  if (!seeds) return tl::unexpected(seeds.error());
  BandSweep band(surface, grid, *seeds);
  if (!progress.report(0.2)) return fail(ErrorCode::Cancelled, "Cancelled before sweeping.");
  band.seed();
  if (auto ok = band.sweep(progress.part(0.5, 0.9, "sweep")); !ok)
    return tl::unexpected(ok.error());
  band.spread();
  band.handOver(take);
  return {};
}

}  // namespace phront
