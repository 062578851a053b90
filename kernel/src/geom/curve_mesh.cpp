#include "phront/curve_mesh.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace phront {

Index curveCount(const CurveMesh& mesh) {
  if (mesh.curveOf.empty()) return mesh.segments.empty() ? 0 : 1;
  return *std::max_element(mesh.curveOf.begin(), mesh.curveOf.end()) + 1;
}

CurveMesh curveThrough(std::vector<Vec2> points, bool closed) {
  CurveMesh mesh;
  mesh.points = std::move(points);
  const auto count = static_cast<Index>(mesh.points.size());
  for (Index i = 0; i + 1 < count; ++i) mesh.segments.push_back({i, i + 1});
  if (closed && count > 1) mesh.segments.push_back({count - 1, 0});
  return mesh;
}

CurveMesh joined(const CurveMesh& a, const CurveMesh& b) {
  CurveMesh mesh = a;
  const auto points = static_cast<Index>(a.points.size());
  mesh.points.insert(mesh.points.end(), b.points.begin(), b.points.end());
  if (mesh.curveOf.empty()) mesh.curveOf.assign(a.segments.size(), 0);
  const Index curves = curveCount(a);
  for (std::size_t s = 0; s < b.segments.size(); ++s) {
    mesh.segments.push_back({b.segments[s][0] + points, b.segments[s][1] + points});
    mesh.curveOf.push_back(b.curve(static_cast<Index>(s)) + curves);
  }
  return mesh;
}

double signedArea(const CurveMesh& mesh) {
  if (mesh.points.empty()) return 0;
  const Vec2 origin = mesh.points.front();  // keeps the products small
  double twice = 0;
  for (const auto& [from, to] : mesh.segments) {
    const Vec2 a = mesh.points[static_cast<std::size_t>(from)] - origin;
    const Vec2 b = mesh.points[static_cast<std::size_t>(to)] - origin;
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

double length(const CurveMesh& mesh) {
  double sum = 0;
  for (const auto& [from, to] : mesh.segments) {
    sum += (mesh.points[static_cast<std::size_t>(to)] - mesh.points[static_cast<std::size_t>(from)])
               .norm();
  }
  return sum;
}

}  // namespace phront
