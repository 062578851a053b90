// Positions never change the connectivity, so a hard case costs shape at the scale of the grid,
// never closedness. Vertices of folded triangles go back to the safe place between their crossings.
#include "front/iso_extraction.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "front/iso_flips.h"
#include "front/iso_triangles.h"

namespace phront {

namespace {

constexpr std::int64_t kGrain = 128;
constexpr int kUnfoldRounds = 5;
constexpr int kKeepCreaseRounds = 2;

}  // namespace

IsoExtraction::IsoExtraction(const SurfaceDistance& surface, const LocalFoot& local,
                             const LevelGrid& grid, int threads)
    : surface_(surface),
      grid_(grid),
      threads_(threads),
      topology_(isoTopology(surface, grid, threads)),
      placer_(surface, grid, topology_, local) {}

Result<IsoSurface> IsoExtraction::run(const Progress& progress) {
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

void IsoExtraction::unfold() {
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
Feature IsoExtraction::featureOf(const Triangle& t) const {
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

IsoSurface IsoExtraction::assemble() const {
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

bool IsoExtraction::missesLevel(const Triangle& t, double tolerance) const {
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

std::vector<Index> IsoExtraction::deviatingCells(double tolerance) const {
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

}  // namespace phront
