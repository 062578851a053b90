// Deviation of the facets from phi = d, sampled.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "front/facet_mesh.h"

namespace phront::facet {

namespace {

constexpr std::int64_t kGrain = 64;
// Samples over the whole surface, spread by area; every triangle gets at least four.
constexpr double kSamples = 60'000;
constexpr int kMostPerSide = 24;

struct Sample {
  double deviation = 0;
  double area = 0;
};

/// Centroids of the n*n congruent parts of a triangle.
template <class Visit>
void forParts(const Vec3& a, const Vec3& b, const Vec3& c, int n, Visit&& visit) {
  const Vec3 u = (b - a) / n;
  const Vec3 v = (c - a) / n;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; i + j < n; ++j) {
      visit(Vec3(a + (i + 1.0 / 3) * u + (j + 1.0 / 3) * v));
      if (i + j + 1 < n) visit(Vec3(a + (i + 2.0 / 3) * u + (j + 2.0 / 3) * v));
    }
  }
}

}  // namespace

void measureFacets(FacetedSurface& result, const WorkMesh& mesh, const Context& context) {
  std::vector<Index> alive;
  double total = 0;
  for (Index t = 0; t < mesh.triangleCount(); ++t) {
    if (!mesh.alive(t) || mesh.frozen(t)) continue;
    alive.push_back(t);
    total += mesh.areaVector(t).norm() / 2;
  }
  std::vector<int> parts;
  std::vector<std::size_t> first{0};
  for (const Index t : alive) {
    const double share = total > 0 ? mesh.areaVector(t).norm() / 2 / total : 0;
    parts.push_back(std::clamp(static_cast<int>(std::sqrt(kSamples * share)), 2, kMostPerSide));
    first.push_back(first.back() + static_cast<std::size_t>(parts.back() * parts.back()));
  }
  std::vector<Sample> samples(first.back());
  parallelFor(static_cast<std::int64_t>(alive.size()), context.threads, kGrain,
              [&](std::int64_t begin, std::int64_t end) {
                for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end);
                     ++i) {
                  const Index t = alive[i];
                  Sample* s = &samples[first[i]];
                  Index hint = mesh.hint[t];
                  const double area = mesh.areaVector(t).norm() / 2 / (parts[i] * parts[i]);
                  forParts(mesh.point(t, 0), mesh.point(t, 1), mesh.point(t, 2), parts[i],
                           [&](const Vec3& x) {
                             const Measured m = measure(context, x, hint);
                             hint = m.triangle;
                             *s++ = {m.deviation, area};
                           });
                }
              });
  std::sort(samples.begin(), samples.end(),
            [](const Sample& a, const Sample& b) { return a.deviation < b.deviation; });
  result.maxDeviation = samples.empty() ? 0 : samples.back().deviation;
  result.p99Deviation = result.maxDeviation;
  double above = 0;
  for (auto s = samples.rbegin(); s != samples.rend() && above <= 0.01 * total; ++s) {
    result.p99Deviation = s->deviation;
    above += s->area;
  }
  result.maxNonPlanarity = 0;
  for (const FacetPolygon& polygon : result.polygons) {
    for (const auto& loop : polygon.loops) {
      for (const Index p : loop) {
        result.maxNonPlanarity =
            std::max(result.maxNonPlanarity,
                     std::abs(polygon.plane.normal.dot(result.points[p]) - polygon.plane.offset));
      }
    }
  }
}

}  // namespace phront::facet
