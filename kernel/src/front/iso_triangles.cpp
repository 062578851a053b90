// Diagonals: between two smooth vertices a diagonal's sag is (b - a) . (n_b - n_a) / 8 to second
// order, no query needed; where a crease vertex takes part phi is asked at the middle of both.
// Folds: a triangle whose normal looks against grad phi at its centroid.
#include "front/iso_triangles.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace phront {

namespace {

constexpr std::int64_t kGrain = 512;
// Normals of all corners agree with the triangle's by this cosine: certainly not folded.
constexpr double kSurelyUnfolded = 0.5;
// Height over longest side below which a triangle has no direction: three vertices on one crease.
constexpr double kFlat = 1e-6;

const IsoVertex& at(const std::vector<IsoVertex>& vertices, Index i) {
  return vertices[static_cast<std::size_t>(i)];
}

double sag(const IsoVertex& a, const IsoVertex& b) {
  return std::abs((b.point - a.point).dot(b.gradient - a.gradient)) / 8;
}

double middleResidual(const SurfaceDistance& surface, const IsoVertex& a, const IsoVertex& b,
                      double level) {
  const Vec3 middle = 0.5 * (a.point + b.point);
  return std::abs(surface.footFrom(middle, a.foot.triangle).phi() - level);
}

/// Twice the area vector.
Vec3 areaVector(const std::vector<IsoVertex>& v, const Triangle& t) {
  return (at(v, t[1]).point - at(v, t[0]).point).cross(at(v, t[2]).point - at(v, t[0]).point);
}

double longestSquared(const std::vector<IsoVertex>& v, const Triangle& t) {
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 side = at(v, t[(k + 1) % 3]).point - at(v, t[k]).point;
    longest = std::max(longest, side.squaredNorm());
  }
  return longest;
}

/// True when the diagonal from corner 0 to corner 2 is the better one.
bool firstDiagonal(const SurfaceDistance& surface, const std::vector<IsoVertex>& v,
                   const std::array<Index, 4>& q, double level) {
  std::array<const IsoVertex*, 4> c{};
  for (std::size_t k = 0; k < 4; ++k) c[k] = &at(v, q[k]);
  const double length0 = (c[2]->point - c[0]->point).norm();
  const double length1 = (c[3]->point - c[1]->point).norm();
  // A quad that is not convex has one diagonal inside: the one with agreeing halves.
  const double agree0 = areaVector(v, {q[0], q[1], q[2]}).dot(areaVector(v, {q[0], q[2], q[3]}));
  const double agree1 = areaVector(v, {q[1], q[2], q[3]}).dot(areaVector(v, {q[1], q[3], q[0]}));
  bool crease = false;
  for (const auto* p : c) crease = crease || p->crease;
  double error0 = 0;
  double error1 = 0;
  if (crease) {
    error0 = middleResidual(surface, *c[0], *c[2], level);
    error1 = middleResidual(surface, *c[1], *c[3], level);
  } else {
    error0 = sag(*c[0], *c[2]);
    error1 = sag(*c[1], *c[3]);
  }
  // Errors that differ by less than a millionth of the size are equal: then convexity and length.
  if (std::abs(error0 - error1) > 1e-6 * (length0 + length1)) return error0 < error1;
  if ((agree0 > 0) != (agree1 > 0)) return agree0 > 0;
  return length0 <= length1;
}

}  // namespace

std::vector<Triangle> splitPolygons(const SurfaceDistance& surface, const IsoTopology& topology,
                                    const std::vector<IsoVertex>& vertices, double level,
                                    int threads) {
  std::vector<Triangle> triangles(2 * topology.quads.size());
  parallelFor(
      static_cast<std::int64_t>(topology.quads.size()), threads, kGrain,
      [&](std::int64_t begin, std::int64_t end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
          const auto& q = topology.quads[i];
          const bool first = firstDiagonal(surface, vertices, q, level);
          triangles[2 * i] = first ? Triangle{q[0], q[1], q[2]} : Triangle{q[1], q[2], q[3]};
          triangles[2 * i + 1] = first ? Triangle{q[0], q[2], q[3]} : Triangle{q[1], q[3], q[0]};
        }
      });
  for (const auto& polygon : topology.polygons) {
    for (std::size_t k = 2; k < polygon.size(); ++k) {
      triangles.push_back({polygon[0], polygon[k - 1], polygon[k]});
    }
  }
  return triangles;
}

std::vector<Index> foldedVertices(const SurfaceDistance& surface,
                                  const std::vector<Triangle>& triangles,
                                  const std::vector<IsoVertex>& vertices, int threads) {
  std::vector<char> folded(triangles.size(), 0);
  parallelFor(
      static_cast<std::int64_t>(triangles.size()), threads, kGrain,
      [&](std::int64_t begin, std::int64_t end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
          const Triangle& t = triangles[i];
          const Vec3 area = areaVector(vertices, t);
          const double size = area.norm();
          double least = size;
          for (const Index v : t) {
            least = std::min(least, area.dot(at(vertices, v).gradient));
          }
          if (least > kSurelyUnfolded * size) continue;
          const Vec3 centroid =
              (at(vertices, t[0]).point + at(vertices, t[1]).point + at(vertices, t[2]).point) / 3;
          const FootPoint foot = surface.footFrom(centroid, at(vertices, t[0]).foot.triangle);
          const double across = area.dot(surface.gradient(centroid, foot));
          folded[i] = across < -kFlat * longestSquared(vertices, t) ? 1 : 0;
        }
      });
  std::vector<Index> out;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (folded[i] != 0) out.insert(out.end(), triangles[i].begin(), triangles[i].end());
  }
  std::ranges::sort(out);
  const auto rest = std::ranges::unique(out);
  out.erase(rest.begin(), rest.end());
  return out;
}

}  // namespace phront
