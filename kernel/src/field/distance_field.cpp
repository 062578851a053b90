// Exact signed distance on sparse tiles.
//
// Tiles come from an octree descent (tile_descent.h). Inside a tile the nodes are visited as one
// snake, and the closest triangle of each bounds the search of the next; the walk of the hierarchy
// then proves the answer, so that no node is ever wrong. It does not depend on where the walk
// starts: same bits for any number of threads and any order of tiles. The sign is that of the
// foot's pseudonormal, audited (sign_audit.h). Weak spot: speed. The proof is a full query per
// node, and the carried bound gains nothing measurable over cold queries (figures in
// geom/surface_distance.cpp).
#include "phront/distance_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "field/sign_audit.h"
#include "field/tile_descent.h"

namespace phront {

namespace {

constexpr int kSize = DistanceField::kTileSize;
constexpr int kBits = 3;               // kSize == 1 << kBits
constexpr std::int64_t kGrain = 4;     // tiles per task: a few ms
constexpr std::int64_t kReports = 50;  // chunks of tiles between two looks at the progress handle

std::size_t nodeInTile(std::int32_t i, std::int32_t j, std::int32_t k) {
  return static_cast<std::size_t>((k * kSize + j) * kSize + i);
}

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
    const auto seeds = tilesOfBand(surface_, grid, progress.part(0, 0.1, "tiles"));
    if (!seeds) return tl::unexpected(seeds.error());
    const auto count = static_cast<std::int64_t>(seeds->size());
    field_.tiles_.resize(seeds->size());
    for (const TileSeed& seed : *seeds) field_.keys_.push_back(seed.coordinates);

    const Progress filling = progress.part(0.1, 0.95, "distance");
    const std::int64_t chunk = std::max<std::int64_t>(16 * kGrain, count / kReports);
    for (std::int64_t from = 0; from < count; from += chunk) {
      if (!filling.report(static_cast<double>(from) / static_cast<double>(count))) {
        return fail(ErrorCode::Cancelled, "Cancelled while distances were computed.");
      }
      parallelFor(std::min(chunk, count - from), options_.threads, kGrain,
                  [&](std::int64_t begin, std::int64_t end) {
                    for (std::int64_t t = from + begin; t < from + end; ++t) {
                      fill((*seeds)[static_cast<std::size_t>(t)],
                           field_.tiles_[static_cast<std::size_t>(t)]);
                    }
                  });
    }
    if (surface_.closed()) {
      field_.signRepairs_ = auditSigns(surface_, field_, field_.tiles_, options_.threads);
    }
    if (!progress.report(1)) return fail(ErrorCode::Cancelled, "Cancelled.");
    return std::move(field_);
  }

 private:
  void fill(const TileSeed& seed, DistanceField::Tile& tile) const {
    tile.coordinates = seed.coordinates;
    Index carried = seed.triangle;
    for (std::int32_t k = 0; k < kSize; ++k) {
      for (std::int32_t row = 0; row < kSize; ++row) {
        const std::int32_t j = k % 2 == 0 ? row : kSize - 1 - row;
        for (std::int32_t column = 0; column < kSize; ++column) {
          const std::int32_t i = (row + k * kSize) % 2 == 0 ? column : kSize - 1 - column;
          const Vec3 x =
              field_.position({seed.coordinates[0] * kSize + i, seed.coordinates[1] * kSize + j,
                               seed.coordinates[2] * kSize + k});
          const FootPoint foot = surface_.footFrom(x, carried);
          carried = foot.triangle;
          const std::size_t n = nodeInTile(i, j, k);
          tile.phi[n] = foot.phi();
          tile.triangle[n] = foot.beyondBorder ? kNone : foot.triangle;
        }
      }
    }
  }

  const SurfaceDistance& surface_;
  const FieldOptions& options_;
  DistanceField field_;
};

Index DistanceField::findTile(const GridIndex& tile) const {
  const auto at = std::lower_bound(keys_.begin(), keys_.end(), tile);
  return at == keys_.end() || *at != tile ? kNone : static_cast<Index>(at - keys_.begin());
}

std::optional<double> DistanceField::phi(const GridIndex& node) const {
  // Arithmetic shift and mask: floor division, also for negative numbers (C++20).
  const Index number = findTile({node[0] >> kBits, node[1] >> kBits, node[2] >> kBits});
  if (number == kNone) return std::nullopt;
  const Tile& tile = tiles_[static_cast<std::size_t>(number)];
  const std::size_t n =
      nodeInTile(node[0] & (kSize - 1), node[1] & (kSize - 1), node[2] & (kSize - 1));
  if (tile.triangle[n] == kNone) return std::nullopt;
  return tile.phi[n];
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
