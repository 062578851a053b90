#include "common/mesh_change.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace thesis {

using phront::Box3;
using phront::Index;
using phront::TriMesh;
using phront::Vec3;

namespace {

using Corners = std::array<Vec3, 3>;

Corners cornersOf(const TriMesh& mesh, std::size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  const auto at = [&](std::size_t k) { return mesh.points[static_cast<std::size_t>(t[k])]; };
  return {at(0), at(1), at(2)};
}

Vec3 doubleArea(const Corners& c) { return (c[1] - c[0]).cross(c[2] - c[0]); }

/// Moeller & Trumbore 1997.
bool goesThrough(const Vec3& from, const Vec3& to, const Corners& c) {
  const Vec3 along = to - from;
  const Vec3 u = c[1] - c[0];
  const Vec3 v = c[2] - c[0];
  const Vec3 p = along.cross(v);
  const double determinant = u.dot(p);
  if (determinant == 0) return false;
  const Vec3 start = from - c[0];
  const double a = start.dot(p) / determinant;
  const Vec3 q = start.cross(u);
  const double b = along.dot(q) / determinant;
  const double t = v.dot(q) / determinant;
  return a >= 0 && b >= 0 && a + b <= 1 && t >= 0 && t <= 1;
}

bool anySideGoesThrough(const Corners& sides, const Corners& c) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (goesThrough(sides[k], sides[(k + 1) % 3], c)) return true;
  }
  return false;
}

bool sharePoint(const std::array<Index, 3>& a, const std::array<Index, 3>& b) {
  return std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end();
}

}  // namespace

Inverted inverted(const TriMesh& before, const TriMesh& after) {
  Inverted found;
  double all = 0;
  for (std::size_t t = 0; t < before.triangles.size(); ++t) {
    const Vec3 normal = doubleArea(cornersOf(before, t));
    all += normal.norm();
    if (normal.dot(doubleArea(cornersOf(after, t))) > 0) continue;
    ++found.triangles;
    found.areaShare += normal.norm();
  }
  if (all > 0) found.areaShare /= all;
  return found;
}

int crossedTriangles(const TriMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  std::vector<Box3> boxes(count);
  for (std::size_t t = 0; t < count; ++t) {
    for (const Vec3& p : cornersOf(mesh, t)) boxes[t].extend(p);
  }
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return boxes[a].min().x() < boxes[b].min().x(); });
  std::vector<bool> crossed(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t a = order[i];
    for (std::size_t j = i + 1; j < count; ++j) {
      const std::size_t b = order[j];
      if (boxes[b].min().x() > boxes[a].max().x()) break;
      if (!boxes[a].intersects(boxes[b])) continue;
      if (sharePoint(mesh.triangles[a], mesh.triangles[b])) continue;
      const Corners first = cornersOf(mesh, a);
      const Corners second = cornersOf(mesh, b);
      if (!anySideGoesThrough(first, second) && !anySideGoesThrough(second, first)) continue;
      crossed[a] = true;
      crossed[b] = true;
    }
  }
  return static_cast<int>(std::count(crossed.begin(), crossed.end(), true));
}

}  // namespace thesis
