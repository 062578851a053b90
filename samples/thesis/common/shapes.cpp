#include "common/shapes.h"

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace thesis {

using phront::CurveMesh;
using phront::Index;
using phront::TriMesh;
using phront::Vec2;
using phront::Vec3;

CurveMesh circle(const Vec2& centre, double radius, int sides) {
  std::vector<Vec2> points;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    points.emplace_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  return phront::curveThrough(std::move(points), true);
}

TriMesh sphere(double radius, int levels) {
  const double g = std::numbers::phi;
  TriMesh mesh;
  for (const double a : {-1.0, 1.0}) {
    for (const double b : {-g, g}) {
      mesh.points.emplace_back(0, a, b);
      mesh.points.emplace_back(a, b, 0);
      mesh.points.emplace_back(b, 0, a);
    }
  }
  // The faces are the triples of corners at distance 2.
  const auto near = [&](std::size_t i, std::size_t j) {
    return std::abs((mesh.points[i] - mesh.points[j]).norm() - 2) < 1e-9;
  };
  for (std::size_t i = 0; i < 12; ++i) {
    for (std::size_t j = i + 1; j < 12; ++j) {
      for (std::size_t k = j + 1; k < 12; ++k) {
        if (!near(i, j) || !near(j, k) || !near(i, k)) continue;
        const Vec3& p = mesh.points[i];
        const bool outward = p.dot(mesh.points[j].cross(mesh.points[k])) > 0;
        const auto a = static_cast<Index>(i);
        const auto b = static_cast<Index>(outward ? j : k);
        const auto c = static_cast<Index>(outward ? k : j);
        mesh.triangles.push_back({a, b, c});
      }
    }
  }
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<Index, Index>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [entry, isNew] =
          middles.try_emplace(std::minmax(a, b), static_cast<Index>(mesh.points.size()));
      if (isNew) {
        mesh.points.emplace_back(0.5 * (mesh.points[static_cast<std::size_t>(a)] +
                                        mesh.points[static_cast<std::size_t>(b)]));
      }
      return entry->second;
    };
    std::vector<std::array<Index, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const Index ab = middle(a, b);
      const Index bc = middle(b, c);
      const Index ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
    for (Vec3& p : mesh.points) p.normalize();
  }
  for (Vec3& p : mesh.points) p = radius * p.normalized();
  return mesh;
}

TriMesh cube(double side, int n) {
  TriMesh mesh;
  std::map<std::array<int, 3>, Index> numbers;
  const auto point = [&](const std::array<int, 3>& at) {
    const auto [entry, isNew] = numbers.try_emplace(at, static_cast<Index>(mesh.points.size()));
    if (isNew) {
      mesh.points.emplace_back(side * (Vec3(at[0], at[1], at[2]) / n - Vec3::Constant(0.5)));
    }
    return entry->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int end : {0, n}) {
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          const auto at = [&](int di, int dj) {
            std::array<int, 3> p;
            p[axis] = end;
            p[(axis + 1) % 3] = i + di;
            p[(axis + 2) % 3] = j + dj;
            return point(p);
          };
          const std::array<Index, 4> q{at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
          if (end == 0) {  // seen from outside the other way round
            mesh.triangles.push_back({q[0], q[2], q[1]});
            mesh.triangles.push_back({q[0], q[3], q[2]});
          } else {
            mesh.triangles.push_back({q[0], q[1], q[2]});
            mesh.triangles.push_back({q[0], q[2], q[3]});
          }
          mesh.faceOf.insert(mesh.faceOf.end(), 2,
                             static_cast<Index>(2 * axis + (end == 0 ? 0 : 1)));
        }
      }
    }
  }
  return mesh;
}

}  // namespace thesis
