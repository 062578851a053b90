// phi = d as a closed labelled mesh: sparse grid, dual marching cubes, vertices on creases.
//
// LevelGrid samples exact phi around the level, isoTopology fixes the connectivity (a closed
// manifold for closed input whatever the positions are), VertexPlacer moves one vertex per patch to
// the level, its creases and corners. Positions never change the connectivity, so a hard case costs
// shape at the scale of the grid, never closedness. Vertices of folded triangles go back to the
// safe place between their crossings. See the three files for papers and weak spots. Why not the
// extended marching cubes of Kobbelt et al. 2001: on tetrahedra or cubes their vertices lie on grid
// edges, about twice as many, slivers at every grid point, and edge flips to undo.
#include "phront/iso_surface.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "front/iso_flips.h"
#include "front/iso_topology.h"
#include "front/iso_triangles.h"
#include "front/iso_vertex.h"
#include "front/level_grid.h"
#include "front/local_foot.h"
#include "front/thin_features.h"

namespace phront {

namespace {

constexpr std::int64_t kGrain = 128;
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
constexpr int kUnfoldRounds = 5;
constexpr int kKeepCreaseRounds = 2;

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
  if (!(options.largestSpacing > 0 && options.mostSquares > 0)) {
    return fail(ErrorCode::InvalidArgument,
                "the largest grid spacing and the number of squares must be positive");
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

void keepDivisible(const LevelGrid& grid, std::vector<Index>& quietCells) {
  std::erase_if(quietCells, [&](Index q) {
    return !grid.canSplit(grid.quietCells()[static_cast<std::size_t>(q)]);
  });
}

/// Splits cells; where that makes few that hide features again these as well, some levels down:
/// cheaper than to extract the surface each time only to learn that it still misses them.
Result<void> splitDown(LevelGrid& grid, const SurfaceDistance& surface,
                       std::span<const Index> deviating, std::vector<Index> hidden,
                       const LevelGridOptions& options, const Progress& progress) {
  for (int level = 0; level < kLevelsAtOnce; ++level) {
    const std::span<const Index> crossed = level == 0 ? deviating : std::span<const Index>();
    if (auto split = grid.split(surface, crossed, hidden, options, progress); !split) return split;
    hidden = cellsOf(findThinFeatures(surface, grid, worthwhileDepth(grid), SearchIn::PendingCells,
                                      options.threads));
    keepDivisible(grid, hidden);
    if (hidden.empty() || hidden.size() > kFewHidden) break;
  }
  return {};
}

/// One extraction on one grid.
class Extraction {
 public:
  Extraction(const SurfaceDistance& surface, const LocalFoot& local, const LevelGrid& grid,
             int threads)
      : surface_(surface),
        grid_(grid),
        threads_(threads),
        topology_(isoTopology(surface, grid, threads)),
        placer_(surface, grid, topology_, local) {}

  Result<IsoSurface> run(const Progress& progress) {
    vertices_.resize(topology_.sites.size());
    const auto count = static_cast<std::int64_t>(vertices_.size());
    constexpr std::int64_t kSlices = 16;  // cancellable between slices
    for (std::int64_t s = 0; s < kSlices; ++s) {
      const std::int64_t from = count * s / kSlices;
      const std::int64_t to = count * (s + 1) / kSlices;
      parallelFor(to - from, threads_, kGrain, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t i = from + begin; i < from + end; ++i) {
          const auto v = static_cast<std::size_t>(i);
          vertices_[v] = placer_.place(topology_.sites[v]);
        }
      });
      if (!progress.report(0.8 * static_cast<double>(s + 1) / kSlices)) {
        return fail(ErrorCode::Cancelled, "cancelled while placing the iso-surface's vertices");
      }
    }
    unfold();
    flipToCreases(surface_, vertices_, grid_.level(), triangles_);
    return assemble();
  }

  /// Cells at creases where the triangles miss the level by more than `tolerance`: they hold more
  /// than one vertex can show. Chords of smooth faces do not count.
  [[nodiscard]] std::vector<Index> deviatingCells(double tolerance) const {
    std::vector<char> deviates(triangles_.size(), 0);
    parallelFor(static_cast<std::int64_t>(triangles_.size()), threads_, kGrain,
                [&](std::int64_t begin, std::int64_t end) {
                  for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end);
                       ++i) {
                    deviates[i] = missesLevel(triangles_[i], tolerance) ? 1 : 0;
                  }
                });
    std::vector<Index> cells;
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      if (deviates[i] == 0) continue;
      for (const Index v : triangles_[i]) {
        cells.push_back(topology_.sites[static_cast<std::size_t>(v)].cell);
      }
    }
    std::ranges::sort(cells);
    const auto rest = std::ranges::unique(cells);
    cells.erase(rest.begin(), rest.end());
    return cells;
  }

 private:
  [[nodiscard]] bool missesLevel(const Triangle& t, double tolerance) const {
    std::array<const IsoVertex*, 3> v{};
    for (std::size_t k = 0; k < 3; ++k) v[k] = &vertices_[static_cast<std::size_t>(t[k])];
    const Feature first = surface_.featureOf(v[0]->foot);
    const bool smooth = std::ranges::all_of(
        v, [&](const IsoVertex* p) { return !p->crease && surface_.featureOf(p->foot) == first; });
    if (smooth) return false;
    const auto misses = [&](const Vec3& x) {
      const double phi = surface_.footFrom(x, v[0]->foot.triangle).phi();
      return std::abs(phi - grid_.level()) > tolerance;
    };
    return misses((v[0]->point + v[1]->point + v[2]->point) / 3) ||
           misses((v[0]->point + v[1]->point) / 2) || misses((v[1]->point + v[2]->point) / 2) ||
           misses((v[2]->point + v[0]->point) / 2);
  }

  void unfold() {
    std::vector<char> safe(vertices_.size(), 0);
    for (int round = 0;; ++round) {
      triangles_ = splitPolygons(surface_, topology_, vertices_, grid_.level(), threads_);
      if (round == kUnfoldRounds) return;
      std::vector<Index> folded = foldedVertices(surface_, triangles_, vertices_, threads_);
      // Vertices on creases give way last.
      std::erase_if(folded, [&](Index v) {
        const auto at = static_cast<std::size_t>(v);
        return safe[at] != 0 || (round < kKeepCreaseRounds && vertices_[at].crease);
      });
      if (folded.empty() && round >= kKeepCreaseRounds) return;
      parallelFor(static_cast<std::int64_t>(folded.size()), threads_, kGrain,
                  [&](std::int64_t begin, std::int64_t end) {
                    for (std::int64_t i = begin; i < end; ++i) {
                      const auto v = static_cast<std::size_t>(folded[static_cast<std::size_t>(i)]);
                      vertices_[v] = placer_.placeSafely(topology_.sites[v]);
                      safe[v] = 1;
                    }
                  });
    }
  }

  /// Feature under the centroid; without a query when three smooth corners agree.
  [[nodiscard]] Feature featureOf(const Triangle& t) const {
    const auto vertex = [&](std::size_t k) -> const IsoVertex& {
      return vertices_[static_cast<std::size_t>(t[k])];
    };
    const Feature first = surface_.featureOf(vertex(0).foot);
    bool agree = true;
    for (std::size_t k = 0; k < 3; ++k) {
      agree = agree && !vertex(k).crease && surface_.featureOf(vertex(k).foot) == first;
    }
    if (agree) return first;
    const Vec3 centroid = (vertex(0).point + vertex(1).point + vertex(2).point) / 3;
    return surface_.featureOf(surface_.footFrom(centroid, vertex(0).foot.triangle));
  }

  IsoSurface assemble() const {
    IsoSurface out;
    out.spacing = grid_.spacing();
    out.finestSpacing = grid_.finestSpacing();
    std::vector<Index> numberOf(vertices_.size(), kNone);
    std::vector<Feature> ofPoint;
    for (const Triangle& t : triangles_) {
      for (const Index v : t) {
        Index& number = numberOf[static_cast<std::size_t>(v)];
        if (number != kNone) continue;
        const IsoVertex& vertex = vertices_[static_cast<std::size_t>(v)];
        number = static_cast<Index>(out.mesh.points.size());
        out.mesh.points.push_back(vertex.point);
        ofPoint.push_back(surface_.featureOf(vertex.foot));
        out.maxResidual = std::max(out.maxResidual, vertex.residual);
      }
    }
    std::vector<Feature> ofTriangle(triangles_.size());
    parallelFor(static_cast<std::int64_t>(triangles_.size()), threads_, kGrain,
                [&](std::int64_t begin, std::int64_t end) {
                  for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end);
                       ++i) {
                    ofTriangle[i] = featureOf(triangles_[i]);
                  }
                });
    out.labels = ofPoint;
    out.labels.insert(out.labels.end(), ofTriangle.begin(), ofTriangle.end());
    std::ranges::sort(out.labels);
    const auto rest = std::ranges::unique(out.labels);
    out.labels.erase(rest.begin(), rest.end());
    const auto labelOf = [&](const Feature& feature) {
      return static_cast<Index>(std::ranges::lower_bound(out.labels, feature) - out.labels.begin());
    };
    for (const Feature& feature : ofPoint) out.labelOfPoint.push_back(labelOf(feature));
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      Triangle t = triangles_[i];
      for (Index& v : t) v = numberOf[static_cast<std::size_t>(v)];
      out.mesh.triangles.push_back(t);
      out.mesh.faceOf.push_back(labelOf(ofTriangle[i]));
    }
    return out;
  }

  const SurfaceDistance& surface_;
  const LevelGrid& grid_;
  int threads_;
  IsoTopology topology_;
  VertexPlacer placer_;
  std::vector<IsoVertex> vertices_;
  std::vector<Triangle> triangles_;
};

}  // namespace

Result<IsoSurface> isoSurface(const SurfaceDistance& surface, const IsoSurfaceOptions& options,
                              const Progress& progress) {
  if (auto ok = check(options); !ok) return tl::unexpected(ok.error());
  LevelGridOptions gridOptions;
  gridOptions.level = options.level;
  gridOptions.spacing = options.spacing.value_or(automaticSpacing(surface, options));
  gridOptions.maxNodes = kMaxNodes;
  gridOptions.threads = options.threads;
  const LocalFoot local(surface);
  std::optional<IsoSurface> best;
  bool refined = false;
  // A finer grid is our own wish: where it fails what is there already stays the answer.
  const auto otherwise = [&](const Error& error) -> Result<IsoSurface> {
    if (best && isGivenUp(error)) return std::move(*best);
    return tl::unexpected(error);
  };
  std::optional<LevelGrid> grid;
  std::vector<Index> hidden;
  std::vector<Index> deviating;
  for (int round = 0; round < kMostRounds; ++round) {
    const double done = round == 0 ? 0.0 : 0.5;
    const Progress field = progress.part(done, done + 0.25, "iso-surface: field");
    if (grid && !(hidden.empty() && deviating.empty())) {
      gridOptions.maxNodes = options.mostRefinedNodes;
      if (auto split = splitDown(*grid, surface, deviating, hidden, gridOptions, field); !split) {
        return otherwise(split.error());
      }
      refined = true;
    } else {
      auto made = LevelGrid::build(surface, gridOptions, field);
      if (!made) return otherwise(made.error());
      grid = std::move(*made);
    }
    Extraction extraction(surface, local, *grid, options.threads);
    auto here = extraction.run(progress.part(done + 0.25, done + 0.5, "iso-surface: vertices"));
    if (!here) return otherwise(here.error());
    best = std::move(*here);
    best->refined = refined;
    const auto nodes = static_cast<std::int64_t>(grid->nodes().size());
    hidden.clear();
    deviating.clear();
    // A small result on a grid chosen for the whole box: finer costs nothing.
    const bool crumb = !options.spacing && !refined && 4 * nodes < kCheapNodes &&
                       !best->mesh.triangles.empty() &&
                       best->mesh.triangles.size() < kCrumbTriangles;
    if (crumb && 4 * nodes <= options.mostRefinedNodes && round < kCrumbHalvings) {
      gridOptions.spacing /= 2;
      continue;
    }
    auto missed = missedFeatures(surface, *grid, best->mesh,
                                 findThinFeatures(surface, *grid, worthwhileDepth(*grid),
                                                  SearchIn::AllCells, options.threads),
                                 options.threads);
    if (!missed) return tl::unexpected(missed.error());
    hidden = cellsOf(*missed);
    deviating = extraction.deviatingCells(options.creaseTolerance);
    best->unresolved = !hidden.empty();  // until a finer grid resolves it
    keepDivisible(*grid, hidden);
    std::erase_if(deviating, [&](Index c) {
      return !grid->canSplit(grid->cells()[static_cast<std::size_t>(c)]);
    });
    if (hidden.empty() && deviating.empty()) break;
    if (nodes >= options.mostRefinedNodes) break;
  }
  return std::move(*best);
}

}  // namespace phront
