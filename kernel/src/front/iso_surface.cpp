// phi = d as a closed labelled mesh: sparse grid, dual marching cubes, vertices on creases.
//
// LevelGrid samples exact phi around the level, isoTopology fixes the connectivity (a closed
// manifold for closed input whatever the positions are), VertexPlacer moves one vertex per patch to
// the level, its creases and corners. Where the surface then misses a thin feature or cuts a crease
// off, cells are halved, and it is extracted anew. See the three files for papers and weak spots.
// Why not the extended marching cubes of Kobbelt et al. 2001: on tetrahedra or cubes their vertices
// lie on grid edges, about twice as many, slivers at every grid point, and edge flips to undo.
// Weak spot: each round extracts the whole surface, though few cells have changed.
#include "phront/iso_surface.h"

#include <algorithm>
#include <cmath>

#include "front/iso_extraction.h"
#include "front/level_grid.h"
#include "front/local_foot.h"
#include "front/thin_features.h"

namespace phront {

namespace {

// Automatic spacing in diagonals of the box: ordinary, and the finest that a small |d| may ask.
constexpr double kOrdinarySpacing = 1.0 / 160;
constexpr double kFinestSpacing = 1.0 / 400;
// Nodes of one grid: about 150 bytes each with their cells, and some 3 microseconds.
constexpr std::int64_t kMaxNodes = 12'000'000;
// Nodes up to which a grid costs next to nothing to make finer.
constexpr std::int64_t kCheapNodes = 400'000;
// Half the thickness worth a finer grid, in spacings: of the grid as first made; where that is
// cheap, of the finest cells.
constexpr double kDepth = 1.0 / 64;
constexpr double kDepthOfLevel = 5e-4;  // of |d|, whatever the spacing
constexpr double kCheapDepth = 2e-3;
// Levels that are split without looking at the surface in between, and the hidden cells up to which
// that is done.
constexpr int kLevelsAtOnce = 3;
constexpr std::size_t kFewHidden = 300;
constexpr int kMostRounds = 16;
constexpr int kCrumbHalvings = 8;
// Triangles below which a result is coarse.
constexpr std::size_t kCrumbTriangles = 3000;

double automaticSpacing(const SurfaceDistance& surface, const IsoSurfaceOptions& options) {
  const double diagonal = surface.box().diagonal().norm();
  const double wanted = std::min(kOrdinarySpacing * diagonal,
                                 std::max(std::abs(options.level) / 2, kFinestSpacing * diagonal));
  const double affordable = std::sqrt(area(surface.mesh()) / options.mostSquares);
  return std::min(std::max(wanted, affordable), options.largestSpacing);
}

Result<void> check(const IsoSurfaceOptions& options) {
  if (!std::isfinite(options.level)) {
    return fail(ErrorCode::InvalidArgument, "the level of an iso-surface must be a finite number");
  }
  if (!(options.largestSpacing > 0 && options.mostSquares > 0 && options.creaseTolerance > 0)) {
    return fail(ErrorCode::InvalidArgument,
                "the largest grid spacing, the number of squares and the tolerance at creases must "
                "be positive");
  }
  if (options.spacing && !(std::isfinite(*options.spacing) && *options.spacing > 0)) {
    return fail(ErrorCode::InvalidArgument,
                "the grid spacing of an iso-surface must be positive and finite");
  }
  if (options.threads < 0) {
    return fail(ErrorCode::InvalidArgument, "the number of threads must be 0 (all) or positive");
  }
  return {};
}

/// A refinement may be given up: it was our own wish.
bool isGivenUp(const Error& error) {
  return error.code == ErrorCode::ResourceLimit || error.code == ErrorCode::Cancelled;
}

/// Half the thickness of features that are worth a finer grid.
double worthwhileDepth(const LevelGrid& grid) {
  if (4 * static_cast<std::int64_t>(grid.nodes().size()) < kCheapNodes) {
    return kCheapDepth * grid.finestSpacing();
  }
  return std::min(kDepth * grid.spacing(), kDepthOfLevel * std::abs(grid.level()));
}

std::vector<Index> cellsOf(const std::vector<ThinFeature>& features) {
  std::vector<Index> cells;
  for (const ThinFeature& feature : features) cells.push_back(feature.quietCell);
  return cells;
}

/// Extracts the surface, makes the grid finer, and again.
class Refinement {
 public:
  Refinement(const SurfaceDistance& surface, const IsoSurfaceOptions& options,
             const Progress& progress)
      : surface_(surface), options_(options), progress_(progress), local_(surface) {
    gridOptions_.level = options.level;
    gridOptions_.spacing = options.spacing.value_or(automaticSpacing(surface, options));
    gridOptions_.maxNodes = kMaxNodes;
    gridOptions_.threads = options.threads;
  }

  Result<IsoSurface> run() {
    while (round_ < kMostRounds) {
      Result<bool> more = step();
      // A finer grid is our own wish: where it fails what is there already stays the answer.
      if (!more && !(best_ && isGivenUp(more.error()))) return tl::unexpected(more.error());
      if (!more || !*more) break;
      ++round_;
    }
    return std::move(*best_);
  }

 private:
  /// One grid and its surface; true when a finer grid is wanted.
  Result<bool> step() {
    const double done = round_ == 0 ? 0.0 : 0.5;
    const Progress field = progress_.part(done, done + 0.25, "iso-surface: field");
    if (auto made = makeGrid(field); !made) return tl::unexpected(made.error());
    IsoExtraction extraction(surface_, local_, *grid_, options_.threads);
    auto here = extraction.run(progress_.part(done + 0.25, done + 0.5, "iso-surface: vertices"));
    if (!here) return tl::unexpected(here.error());
    best_ = std::move(*here);
    best_->refined = grid_->finestSpacing() < grid_->spacing();
    hidden_.clear();
    deviating_.clear();
    if (isCrumb()) {
      gridOptions_.spacing /= 2;
      return true;
    }
    return look(extraction);
  }

  /// The first grid, one twice as fine, or the last one with cells halved.
  Result<void> makeGrid(const Progress& progress) {
    if (grid_ && !(hidden_.empty() && deviating_.empty())) return split(progress);
    auto made = LevelGrid::build(surface_, gridOptions_, progress);
    if (!made) return tl::unexpected(made.error());
    grid_ = std::move(*made);
    return {};
  }

  /// Where that makes few cells that hide features again these are split as well, some levels down:
  /// cheaper than to extract the surface each time only to learn that it still misses them.
  Result<void> split(const Progress& progress) {
    gridOptions_.maxNodes = options_.mostRefinedNodes;
    for (int level = 0; level < kLevelsAtOnce; ++level) {
      if (auto split = grid_->split(surface_, deviating_, hidden_, gridOptions_, progress);
          !split) {
        return split;
      }
      deviating_.clear();
      hidden_ = divisible(cellsOf(findThinFeatures(surface_, *grid_, worthwhileDepth(*grid_),
                                                   SearchIn::PendingCells, options_.threads)));
      if (hidden_.empty() || hidden_.size() > kFewHidden) break;
    }
    return {};
  }

  /// A small result on a grid chosen for the whole box: finer costs nothing.
  [[nodiscard]] bool isCrumb() const {
    const auto nodes = static_cast<std::int64_t>(grid_->nodes().size());
    const std::size_t triangles = best_->mesh.triangles.size();
    return !options_.spacing && !best_->refined && round_ < kCrumbHalvings && triangles > 0 &&
           triangles < kCrumbTriangles && 4 * nodes < kCheapNodes &&
           4 * nodes <= options_.mostRefinedNodes;
  }

  /// What the surface misses; true when that can be mended.
  Result<bool> look(const IsoExtraction& extraction) {
    auto missed = missedFeatures(surface_, *grid_, best_->mesh,
                                 findThinFeatures(surface_, *grid_, worthwhileDepth(*grid_),
                                                  SearchIn::AllCells, options_.threads),
                                 options_.threads);
    if (!missed) return tl::unexpected(missed.error());
    best_->unresolved = !missed->empty();  // until a finer grid resolves it
    hidden_ = divisible(cellsOf(*missed));
    deviating_ = extraction.deviatingCells(options_.creaseTolerance);
    std::erase_if(deviating_, [&](Index c) {
      return !grid_->canSplit(grid_->cells()[static_cast<std::size_t>(c)]);
    });
    const auto nodes = static_cast<std::int64_t>(grid_->nodes().size());
    return !(hidden_.empty() && deviating_.empty()) && nodes < options_.mostRefinedNodes;
  }

  [[nodiscard]] std::vector<Index> divisible(std::vector<Index> quietCells) const {
    std::erase_if(quietCells, [&](Index q) {
      return !grid_->canSplit(grid_->quietCells()[static_cast<std::size_t>(q)]);
    });
    return quietCells;
  }

  const SurfaceDistance& surface_;
  const IsoSurfaceOptions& options_;
  const Progress& progress_;
  const LocalFoot local_;
  LevelGridOptions gridOptions_;
  std::optional<LevelGrid> grid_;
  std::optional<IsoSurface> best_;
  std::vector<Index> hidden_;     // quiet cells that hide what the surface misses
  std::vector<Index> deviating_;  // crossed cells where it cuts creases off
  int round_ = 0;
};

}  // namespace

Result<IsoSurface> isoSurface(const SurfaceDistance& surface, const IsoSurfaceOptions& options,
                              const Progress& progress) {
  if (auto ok = check(options); !ok) return tl::unexpected(ok.error());
  return Refinement(surface, options, progress).run();
}

}  // namespace phront
