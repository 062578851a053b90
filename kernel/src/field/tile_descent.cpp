// Octree descent to the tiles of a band. phi changes by at most the distance walked (it is
// 1-Lipschitz), so a block of nodes with half diagonal R around c holds only phi(c) - R .. phi(c) +
// R: blocks whose range misses the band are dropped, the others are cut in eight down to single
// tiles. One query per block, each started from the triangle found for its parent; the cost is that
// of the tiles kept, not of the volume. Weak spot: the sign at block centres is trusted (closed
// surfaces).
#include "field/tile_descent.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace phront {

namespace {

constexpr double kSlack = 1 + 1e-9;    // of block radii: swallows the rounding of phi at the centre
constexpr double kMaxTiles = 1 << 26;  // per axis: node numbers stay far inside 32 bits
constexpr std::int64_t kGrain = 64;    // blocks per task: about 0.1 ms

bool meetsBand(const BandGrid& grid, bool watertight, const FootPoint& foot, double radius) {
  if (watertight) return foot.phi() + radius >= grid.bandMin && foot.phi() - radius <= grid.bandMax;
  const bool across = grid.bandMin <= 0 && grid.bandMax >= 0;
  const double nearest = across ? 0 : std::min(std::abs(grid.bandMin), std::abs(grid.bandMax));
  const double farthest = std::max(std::abs(grid.bandMin), std::abs(grid.bandMax));
  return foot.distance + radius >= nearest && foot.distance - radius <= farthest;
}

// Blocks of one level, each of 2^level tiles a side.
std::vector<TileSeed> keepMeeting(const SurfaceDistance& surface, const BandGrid& grid, int level,
                                  std::vector<TileSeed> blocks) {
  const double nodes = static_cast<double>(DistanceField::kTileSize) * std::exp2(level);
  const double toCentre = (nodes - 1) / 2 * grid.spacing;
  const double radius = std::sqrt(3.0) * toCentre * kSlack;
  std::vector<char> keep(blocks.size(), 0);
  parallelFor(
      static_cast<std::int64_t>(blocks.size()), grid.threads, kGrain,
      [&](std::int64_t begin, std::int64_t end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
          TileSeed& block = blocks[i];
          const Vec3 corner(block.coordinates[0], block.coordinates[1], block.coordinates[2]);
          const Vec3 centre = grid.origin + DistanceField::kTileSize * grid.spacing * corner +
                              Vec3::Constant(toCentre);
          const FootPoint foot = surface.footFrom(centre, block.triangle);
          block.triangle = foot.triangle;
          keep[i] = meetsBand(grid, surface.watertight(), foot, radius) ? 1 : 0;
        }
      });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (keep[i] != 0) blocks[kept++] = blocks[i];
  }
  blocks.resize(kept);
  return blocks;
}

std::vector<TileSeed> cutInEight(const std::vector<TileSeed>& blocks, int level) {
  const auto half = static_cast<std::int32_t>(1) << (level - 1);
  std::vector<TileSeed> children;
  children.reserve(8 * blocks.size());
  for (const TileSeed& block : blocks) {
    for (int octant = 0; octant < 8; ++octant) {
      TileSeed child = block;
      for (int axis = 0; axis < 3; ++axis) {
        child.coordinates[static_cast<std::size_t>(axis)] += (octant >> axis & 1) * half;
      }
      children.push_back(child);
    }
  }
  return children;
}

}  // namespace

Result<std::vector<TileSeed>> tilesOfBand(const SurfaceDistance& surface, const BandGrid& grid,
                                          const Progress& progress) {
  const double tile = DistanceField::kTileSize * grid.spacing;
  const double reach = surface.watertight() ? std::max(grid.bandMax, 0.0)
                                        : std::max(std::abs(grid.bandMin), std::abs(grid.bandMax));
  const Vec3 margin = Vec3::Constant(reach + grid.spacing);
  const Vec3 low = (surface.box().min() - margin - grid.origin) / tile;
  const Vec3 high = (surface.box().max() + margin - grid.origin) / tile;
  const double largest = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
  auto tooFine = [&] {
    return fail(
        ErrorCode::ResourceLimit,
        fmt::format("Spacing {:g} is too fine for a model of size {:g}: the band {:g} .. {:g} "
                    "needs more than {} nodes. Use a coarser spacing or a narrower band.",
                    grid.spacing, surface.box().diagonal().norm(), grid.bandMin, grid.bandMax,
                    grid.maxNodes));
  };
  if (!(largest < kMaxTiles)) return tooFine();

  TileSeed root;
  double extent = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double first = std::floor(low[axis]);
    root.coordinates[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(first);
    extent = std::max(extent, std::floor(high[axis]) - first + 1);
  }
  int level = 0;
  while (std::exp2(level) < extent) ++level;
  const int levels = level;

  std::vector<TileSeed> blocks{root};
  for (;; --level) {
    if (!progress.report(1 - level / (levels + 1.0))) {
      return fail(ErrorCode::Cancelled, "Cancelled while the tiles of the band were sought.");
    }
    blocks = keepMeeting(surface, grid, level, std::move(blocks));
    // A block of a coarser level may yet turn out empty, so it counts for less than a tile.
    const auto nodes = static_cast<std::int64_t>(blocks.size()) * DistanceField::kNodesPerTile;
    if ((level == 0 ? nodes : nodes / 8) > grid.maxNodes) return tooFine();
    if (level == 0) break;
    blocks = cutInEight(blocks, level);
  }
  std::sort(blocks.begin(), blocks.end(),
            [](const TileSeed& a, const TileSeed& b) { return a.coordinates < b.coordinates; });
  return blocks;
}

}  // namespace phront
