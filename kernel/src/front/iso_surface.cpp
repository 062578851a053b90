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
// Halvings for thin features: always, and as long as the next grid stays below kCheapNodes.
constexpr int kHalvings = 3;
constexpr int kCheapHalvings = 8;
constexpr std::int64_t kCheapNodes = 400'000;
// Half the thickness worth a halving: what the last one resolves, in first spacings; where halving
// is cheap, in spacings of the grid at hand.
constexpr double kOrdinaryDepth = 1.0 / 16;
constexpr double kCheapDepth = 2e-3;
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

/// One extraction at one spacing.
class Extraction {
 public:
  Extraction(const SurfaceDistance& surface, const LocalFoot& local, const LevelGrid& grid,
             int threads)
      : surface_(surface), grid_(grid), threads_(threads), placer_(surface, grid, local) {}

  Result<IsoSurface> run(const Progress& progress) {
    topology_ = isoTopology(surface_, grid_, threads_);
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

 private:
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
  VertexPlacer placer_;
  IsoTopology topology_;
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
  const double firstSpacing = gridOptions.spacing;
  const LocalFoot local(surface);
  bool refined = false;
  std::optional<IsoSurface> best;
  for (int halving = 0;; ++halving) {
    const double done = halving == 0 ? 0.0 : 0.5;
    auto grid = LevelGrid::build(surface, gridOptions,
                                 progress.part(done, done + 0.25, "iso-surface: field"));
    if (!grid) {
      // A finer grid was our own wish: what is there already stays the answer.
      if (best && isGivenUp(grid.error())) return *best;
      return tl::unexpected(grid.error());
    }
    auto surfaceHere = Extraction(surface, local, *grid, options.threads)
                           .run(progress.part(done + 0.25, done + 0.5, "iso-surface: vertices"));
    if (!surfaceHere) {
      if (best && isGivenUp(surfaceHere.error())) return *best;
      return tl::unexpected(surfaceHere.error());
    }
    surfaceHere->refined = refined;
    best = std::move(*surfaceHere);
    const auto nodes = static_cast<std::int64_t>(grid->nodes().size());
    const bool cheap = 4 * nodes < kCheapNodes && halving < kCheapHalvings;
    if (halving >= kHalvings && !cheap) return *best;
    const double depth = cheap ? kCheapDepth * gridOptions.spacing : kOrdinaryDepth * firstSpacing;
    // A small result on a grid chosen for the whole box: finer costs nothing.
    const bool crumb = !options.spacing && cheap && !best->mesh.triangles.empty() &&
                       best->mesh.triangles.size() < kCrumbTriangles;
    const bool allowed = 4 * nodes <= options.mostRefinedNodes;
    if (crumb && !allowed) return *best;
    if (!crumb) {
      const auto hidden = hidesThinFeature(surface, *grid, best->mesh, depth, options.threads);
      if (!hidden) return tl::unexpected(hidden.error());
      if (!*hidden) return *best;
      best->unresolved = true;  // until the next grid resolves it
      if (!allowed) return *best;
      refined = true;
    }
    gridOptions.spacing /= 2;
  }
}

}  // namespace phront
