// Exact signed distance on sparse tiles.
//
// Tiles come from an octree descent (tile_descent.h). Exact: the nodes of a tile get their closest
// triangles together (geom/block_query.h): proven, so that no node is ever wrong, and independent
// of the order of tiles: same bits for any number of threads. The sign is that of the foot's
// pseudonormal, audited (sign_audit.h).
#include "phront/distance_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "field/sign_audit.h"
#include "field/swept_band.h"
#include "field/tile_descent.h"

namespace phront {

namespace {

constexpr int kSize = DistanceField::kTileSize;
constexpr int kBits = 3;               // kSize == 1 << kBits
constexpr std::int64_t kGrain = 4;     // tiles per task: a few tenths of a ms
constexpr std::int64_t kChunk = 1024;  // tiles that are kept unpacked; then the progress handle

std::size_t index(std::int64_t i) { return static_cast<std::size_t>(i); }

Result<void> checkOptions(const FieldOptions& options) {
  if (!(options.spacing > 0) || !std::isfinite(options.spacing)) {
    return fail(
        ErrorCode::InvalidArgument,
        fmt::format("The grid spacing must be positive and finite, not {:g}.", options.spacing),
        "spacing");
  }
  if (!std::isfinite(options.bandMin) || !std::isfinite(options.bandMax) ||
      options.bandMin > options.bandMax) {
    return fail(ErrorCode::InvalidArgument,
                fmt::format("The band {:g} .. {:g} is empty: it needs finite bandMin <= bandMax.",
                            options.bandMin, options.bandMax),
                "band");
  }
  if (options.origin && !options.origin->allFinite()) {
    return fail(ErrorCode::InvalidArgument, "The origin of the grid must be finite.", "origin");
  }
  if (options.threads < 0) {
    return fail(ErrorCode::InvalidArgument, "The number of threads must not be negative.",
                "threads");
  }
  return {};
}

}  // namespace

class FieldBuilder {
 public:
  FieldBuilder(const SurfaceDistance& surface, const FieldOptions& options)
      : surface_(surface), options_(options) {
    field_.spacing_ = options.spacing;
    field_.origin_ = options.origin.value_or(surface.box().min());
  }

  Result<DistanceField> build(const Progress& progress) {
    const BandGrid grid{field_.origin_,   options_.spacing, options_.bandMin,
                        options_.bandMax, options_.threads, options_.maxNodes};
    const auto filled = options_.solver == FieldSolver::Exact ? query(grid, progress.part(0, 0.95))
                                                              : sweep(grid, progress.part(0, 0.95));
    if (!filled) return tl::unexpected(filled.error());
    if (surface_.closed()) {
      field_.signRepairs_ = auditSigns(surface_, field_, field_.phi_, options_.threads);
    }
    dropOutside();
    field_.phi_.shrink_to_fit();
    field_.triangle_.shrink_to_fit();
    if (!progress.report(1)) return fail(ErrorCode::Cancelled, "Cancelled.");
    return std::move(field_);
  }

 private:
  Result<void> query(const BandGrid& grid, const Progress& progress) {
    const auto seeds = tilesOfBand(surface_, grid, progress.part(0, 0.1, "tiles"));
    if (!seeds) return tl::unexpected(seeds.error());
    const auto count = static_cast<std::int64_t>(seeds->size());
    const Progress filling = progress.part(0.1, 1, "distance");
    std::vector<BlockPhi> blocks(index(std::min(kChunk, count)));
    for (std::int64_t from = 0; from < count; from += kChunk) {
      if (!filling.report(static_cast<double>(from) / static_cast<double>(count))) {
        return fail(ErrorCode::Cancelled, "Cancelled while distances were computed.");
      }
      const std::int64_t size = std::min(kChunk, count - from);
      parallelFor(size, options_.threads, kGrain, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t t = begin; t < end; ++t)
          blocks[index(t)] = blockOf((*seeds)[index(from + t)]);
      });
      for (std::int64_t t = 0; t < size; ++t)
        append((*seeds)[index(from + t)].coordinates, blocks[index(t)]);
    }
    return {};
  }

  Result<void> sweep(const BandGrid& grid, const Progress& progress) {
    if (!surface_.watertight()) {
      return fail(
          ErrorCode::InvalidArgument,
          "Sweeping needs a closed surface: beyond a border there is no sign to spread. Use "
          "the exact solver.",
          "solver");
    }
    return sweepBand(
        surface_, grid, [&](const GridIndex& tile, const BlockPhi& block) { append(tile, block); },
        progress);
  }

  BlockPhi blockOf(const TileSeed& seed) const {
    const auto& [a, b, c] = seed.coordinates;
    const double reach = std::max(std::abs(options_.bandMin), std::abs(options_.bandMax));
    return surface_.phiOnBlock(field_.origin(), options_.spacing, {a * kSize, b * kSize, c * kSize},
                               reach, seed.triangle);
  }

  void append(const GridIndex& coordinates, const BlockPhi& block) {
    DistanceField::Tile tile{coordinates, block.held,
                             static_cast<std::int64_t>(field_.phi_.size())};
    for (std::size_t n = 0; n < block.phi.size(); ++n) {
      if ((block.held[n >> 6] >> (n & 63) & 1U) == 0) continue;
      field_.phi_.push_back(block.phi[n]);
      field_.triangle_.push_back(block.triangle[n]);
    }
    if (static_cast<std::int64_t>(field_.phi_.size()) > tile.first) field_.tiles_.push_back(tile);
  }

  [[nodiscard]] bool inBand(double phi) const {
    if (surface_.closed()) return phi >= options_.bandMin && phi <= options_.bandMax;
    // The sign jumps beyond the border: either side counts.
    const double size = std::abs(phi);
    return (size >= options_.bandMin && size <= options_.bandMax) ||
           (-size >= options_.bandMin && -size <= options_.bandMax);
  }

  /// Signs are final: what was found on the way to the band goes.
  void dropOutside() {
    std::size_t kept = 0;
    std::size_t slot = 0;
    for (DistanceField::Tile& tile : field_.tiles_) {
      tile.first = static_cast<std::int64_t>(kept);
      for (std::uint64_t& word : tile.held) {
        for (std::uint64_t left = word; left != 0; left &= left - 1, ++slot) {
          const double phi = field_.phi_[slot];
          if (!inBand(phi)) {
            word &= ~(left & (~left + 1));
            continue;
          }
          field_.phi_[kept] = phi;
          field_.triangle_[kept++] = field_.triangle_[slot];
        }
      }
    }
    field_.phi_.resize(kept);
    field_.triangle_.resize(kept);
    std::erase_if(field_.tiles_, [](const DistanceField::Tile& tile) {
      return std::all_of(tile.held.begin(), tile.held.end(), [](auto word) { return word == 0; });
    });
  }

  const SurfaceDistance& surface_;
  const FieldOptions& options_;
  DistanceField field_;
};

std::size_t DistanceField::memory() const {
  return sizeof *this + tiles_.capacity() * sizeof(Tile) + phi_.capacity() * sizeof(double) +
         triangle_.capacity() * sizeof(Index);
}

Index DistanceField::findTile(const GridIndex& tile) const {
  const auto at =
      std::lower_bound(tiles_.begin(), tiles_.end(), tile,
                       [](const Tile& a, const GridIndex& b) { return a.coordinates < b; });
  return at == tiles_.end() || at->coordinates != tile ? kNone
                                                       : static_cast<Index>(at - tiles_.begin());
}

std::optional<double> DistanceField::phi(const GridIndex& node) const {
  // Arithmetic shift and mask: floor division, also for negative numbers (C++20).
  const Index number = findTile({node[0] >> kBits, node[1] >> kBits, node[2] >> kBits});
  if (number == kNone) return std::nullopt;
  constexpr std::int32_t kMask = kSize - 1;
  const std::int64_t slot = tiles_[index(number)].slot(
      ((node[2] & kMask) * kSize + (node[1] & kMask)) * kSize + (node[0] & kMask));
  if (slot < 0 || triangle_[index(slot)] == kNone) return std::nullopt;
  return phi_[index(slot)];
}

std::optional<double> DistanceField::interpolate(const Vec3& x) const {
  const Vec3 u = (x - origin_) / spacing_;
  if (!(u.cwiseAbs().maxCoeff() < 1 << 30)) return std::nullopt;  // also NaN
  GridIndex low;
  Vec3 w;
  for (int axis = 0; axis < 3; ++axis) {
    const double floor = std::floor(u[axis]);
    low[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(floor);
    w[axis] = u[axis] - floor;
  }
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int i = corner & 1;
    const int j = corner >> 1 & 1;
    const int k = corner >> 2 & 1;
    const auto value = phi({low[0] + i, low[1] + j, low[2] + k});
    if (!value) return std::nullopt;
    sum += *value * (i == 1 ? w[0] : 1 - w[0]) * (j == 1 ? w[1] : 1 - w[1]) *
           (k == 1 ? w[2] : 1 - w[2]);
  }
  return sum;
}

Result<DistanceField> solveDistanceField(const SurfaceDistance& surface,
                                         const FieldOptions& options, const Progress& progress) {
  if (auto ok = checkOptions(options); !ok) return tl::unexpected(ok.error());
  return FieldBuilder(surface, options).build(progress);
}

}  // namespace phront
