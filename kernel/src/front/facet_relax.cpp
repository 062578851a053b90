// Points that float: half the deviation of the facets around goes to the points.
//
// After the collapse all points lie on phi = d, so on curved surfaces all facets lie on one side of
// it. Moving each point against the mean deviation of its facets by half of it puts the surface
// between points and facets and halves the largest deviation. Points in planes stay: their borders
// bound polygons. A move that would turn a facet is not made.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "front/facet_mesh.h"

namespace phront::facet {

namespace {

constexpr std::int64_t kGrain = 256;
constexpr double kShare = 0.5;
// Cosine of the largest turn of a facet, 18 degrees.
constexpr double kLargestTurn = 0.95;

/// Signed deviation of each free triangle at its centroid; renews hints and tangents.
std::vector<double> deviations(WorkMesh& mesh, const Context& context) {
  std::vector<double> result(mesh.corners.size(), 0);
  parallelFor(mesh.triangleCount(), context.threads, kGrain,
              [&](std::int64_t begin, std::int64_t end) {
                for (auto t = static_cast<Index>(begin); t < end; ++t) {
                  if (!mesh.alive(t) || mesh.frozen(t) || mesh.plane[t] != kNone) continue;
                  const Vec3 x = mesh.centroid(t);
                  const FootPoint foot = context.surface.footFrom(x, mesh.hint[t]);
                  result[t] = foot.phi() - context.level;
                  mesh.hint[t] = foot.triangle;
                  mesh.tangent[t] = context.surface.gradient(x, foot);
                }
              });
  return result;
}

bool turnsNothing(const WorkMesh& mesh, const Context& context, Index p, const Vec3& x) {
  for (const Index t : mesh.around[p]) {
    const int k = mesh.cornerOf(t, p);
    const Vec3& a = mesh.point(t, (k + 1) % 3);
    const Vec3& b = mesh.point(t, (k + 2) % 3);
    const Vec3 before = mesh.areaVector(t);
    const Vec3 after = (a - x).cross(b - x);
    if (after.dot(before) < kLargestTurn * after.norm() * before.norm()) return false;
    if (smallestHeight(x, a, b) < context.heightFloor) return false;
  }
  return true;
}

}  // namespace

void relax(WorkMesh& mesh, const Context& context, double tolerance) {
  const std::vector<double> deviation = deviations(mesh, context);
  for (Index p = mesh.fixedPoints; p < mesh.pointCount(); ++p) {
    if (mesh.around[p].empty() || !mesh.exactPlanes[p].empty()) continue;
    double mean = 0;
    double weight = 0;
    Vec3 direction = Vec3::Zero();
    for (const Index t : mesh.around[p]) {
      if (mesh.plane[t] != kNone) continue;
      const double area = mesh.areaVector(t).norm();
      mean += area * deviation[t];
      weight += area;
      direction += area * mesh.tangent[t];
    }
    if (!(weight > 0) || !(direction.norm() > 0)) continue;
    direction.normalize();
    const double step = std::clamp(-kShare * mean / weight, -tolerance, tolerance);
    const Vec3 x = mesh.points[p] + step * direction;
    if (turnsNothing(mesh, context, p, x)) mesh.points[p] = x;
  }
}

}  // namespace phront::facet
