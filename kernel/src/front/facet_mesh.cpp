#include "front/facet_mesh.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace phront::facet {

namespace {
constexpr std::int64_t kGrain = 256;  // a foot query takes microseconds: some 1 ms per chunk
}

Index WorkMesh::across(Index t, int side) const {
  const Index from = corners[t][side];
  const Index to = corners[t][(side + 1) % 3];
  for (const Index other : around[from]) {
    if (other == t) continue;
    const int k = cornerOf(other, to);
    if (corners[other][k] == to && corners[other][(k + 1) % 3] == from) return other;
  }
  return kNone;
}

Index WorkMesh::aliveCount() const {
  return static_cast<Index>(std::count_if(corners.begin(), corners.end(),
                                          [](const Corners& c) { return c[0] != kNone; }));
}

double smallestHeight(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest =
      std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
  return longest > 0 ? (b - a).cross(c - a).norm() / longest : 0.0;
}

double distanceToTriangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  // Regions of the barycentric plane (Ericson 2005, section 5.1.5).
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 ax = x - a;
  const double d1 = ab.dot(ax);
  const double d2 = ac.dot(ax);
  if (d1 <= 0 && d2 <= 0) return ax.norm();
  const Vec3 bx = x - b;
  const double d3 = ab.dot(bx);
  const double d4 = ac.dot(bx);
  if (d3 >= 0 && d4 <= d3) return bx.norm();
  const Vec3 cx = x - c;
  const double d5 = ab.dot(cx);
  const double d6 = ac.dot(cx);
  if (d6 >= 0 && d5 <= d6) return cx.norm();
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return (ax - ab * (d1 / (d1 - d3))).norm();
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return (ax - ac * (d2 / (d2 - d6))).norm();
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    return (bx - (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)))).norm();
  }
  const double sum = va + vb + vc;
  if (!(sum > 0)) return std::min({ax.norm(), bx.norm(), cx.norm()});
  return (ax - ab * (vb / sum) - ac * (vc / sum)).norm();
}

Measured measure(const Context& context, const Vec3& x, Index hint) {
  const FootPoint foot =
      hint == kNone ? context.surface.foot(x) : context.surface.footFrom(x, hint);
  return {std::abs(foot.phi() - context.level), context.surface.gradient(x, foot), foot.triangle};
}

WorkMesh makeWorkMesh(const Context& context, const IsoSurface& iso) {
  WorkMesh mesh;
  mesh.points = iso.mesh.points;
  mesh.corners = iso.mesh.triangles;
  const std::size_t count = mesh.corners.size();
  mesh.label = iso.mesh.faceOf.empty() ? std::vector<Index>(count, 0) : iso.mesh.faceOf;
  mesh.plane.assign(count, kNone);
  mesh.hint.assign(count, kNone);
  mesh.tangent.assign(count, Vec3::Zero());
  mesh.around.resize(mesh.points.size());
  mesh.exactPlanes.resize(mesh.points.size());
  for (Index t = 0; t < mesh.triangleCount(); ++t) {
    for (const Index p : mesh.corners[t]) mesh.around[p].push_back(t);
  }
  parallelFor(mesh.triangleCount(), context.threads, kGrain,
              [&](std::int64_t begin, std::int64_t end) {
                Index near = kNone;
                for (auto t = static_cast<Index>(begin); t < end; ++t) {
                  const Measured m = measure(context, mesh.centroid(t), near);
                  near = mesh.hint[t] = m.triangle;
                  mesh.tangent[t] = m.gradient;
                }
              });
  return mesh;
}

}  // namespace phront::facet
