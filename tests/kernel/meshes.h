// Meshes whose distance is known: box, L-shape, sphere, torus. Labelled like B-Reps, oriented
// outward, points shared.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "phront/tri_mesh.h"

namespace phront::test {

/// Right prism over a counter-clockwise polygon in the xy plane, from z = low to z = high.
/// Faces: 0..n-1 the side over polygon edge i, n the bottom, n + 1 the top. Edges: i bottom edge i,
/// n + i top edge i, 2n + i the upright at corner i. Vertices: i bottom, n + i top. `caps` lists
/// the triangles of the polygon, counter-clockwise.
inline TriMesh prism(const std::vector<std::array<double, 2>>& polygon,
                     const std::vector<std::array<Index, 3>>& caps, double low, double high) {
  TriMesh mesh;
  const auto n = static_cast<Index>(polygon.size());
  for (const double z : {low, high}) {
    for (const auto& p : polygon) mesh.points.emplace_back(p[0], p[1], z);
  }
  for (Index i = 0; i < 2 * n; ++i) mesh.vertexOf.push_back(i);
  std::map<std::pair<Index, Index>, Index> edges;
  for (Index i = 0; i < n; ++i) {
    const Index j = (i + 1) % n;
    edges[std::minmax({i, j})] = i;
    edges[std::minmax({n + i, n + j})] = n + i;
    edges[std::minmax({i, n + i})] = 2 * n + i;
  }
  auto add = [&](Index a, Index b, Index c, Index face) {
    mesh.triangles.push_back({a, b, c});
    mesh.faceOf.push_back(face);
    for (const auto& side : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
      const auto at = edges.find(std::minmax({side.first, side.second}));
      mesh.edgeOf.push_back(at == edges.end() ? kNone : at->second);
    }
  };
  for (Index i = 0; i < n; ++i) {
    const Index j = (i + 1) % n;
    add(i, j, n + j, i);
    add(i, n + j, n + i, i);
  }
  for (const auto& t : caps) add(t[0], t[2], t[1], n);
  for (const auto& t : caps) add(n + t[0], n + t[1], n + t[2], n + 1);
  return mesh;
}

/// Axis-aligned box: 12 triangles, 6 faces, 12 edges, 8 vertices.
inline TriMesh box(const Vec3& low, const Vec3& high) {
  return prism({{low[0], low[1]}, {high[0], low[1]}, {high[0], high[1]}, {low[0], high[1]}},
               {{0, 1, 2}, {0, 2, 3}}, low[2], high[2]);
}

/// L-shape: [0,2] x [0,2] without (1,2] x (1,2], times z in [0,1]. Its concave edge is the upright
/// at (1,1): edge 2 * 6 + 3.
inline TriMesh lShape() {
  return prism({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}},
               {{0, 1, 3}, {1, 2, 3}, {0, 3, 5}, {3, 4, 5}}, 0, 1);
}

/// Every triangle of a mesh of the unit sphere cut in four, `levels` times; points stay on it.
inline void refineUnitSphere(TriMesh& mesh, int levels) {
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<Index, Index>, Index> middles;
    auto middle = [&](Index a, Index b) {
      const auto [at, isNew] =
          middles.try_emplace(std::minmax({a, b}), static_cast<Index>(mesh.points.size()));
      if (isNew) {
        const Vec3 m =
            mesh.points[static_cast<std::size_t>(a)] + mesh.points[static_cast<std::size_t>(b)];
        mesh.points.push_back(m.normalized());
      }
      return at->second;
    };
    std::vector<std::array<Index, 3>> finer;
    for (const auto& t : mesh.triangles) {
      const Index ab = middle(t[0], t[1]);
      const Index bc = middle(t[1], t[2]);
      const Index ca = middle(t[2], t[0]);
      finer.push_back({t[0], ab, ca});
      finer.push_back({t[1], bc, ab});
      finer.push_back({t[2], ca, bc});
      finer.push_back({ab, bc, ca});
    }
    mesh.triangles = std::move(finer);
  }
}

/// Octahedron with every triangle cut in four `levels` times, points on the sphere. One face.
inline TriMesh sphere(double radius, int levels, const Vec3& centre = Vec3::Zero()) {
  TriMesh mesh;
  mesh.points = {Vec3(1, 0, 0),  Vec3(-1, 0, 0), Vec3(0, 1, 0),
                 Vec3(0, -1, 0), Vec3(0, 0, 1),  Vec3(0, 0, -1)};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  refineUnitSphere(mesh, levels);
  for (Vec3& p : mesh.points) p = centre + radius * p;
  mesh.faceOf.assign(mesh.triangles.size(), 0);
  return mesh;
}

/// The same from the icosahedron, 20 * 4^levels triangles of nearly one shape; radius 1. One face.
inline TriMesh icosphere(int levels) {
  TriMesh mesh;
  const double g = std::numbers::phi;
  // Three golden rectangles, one in each coordinate plane.
  for (const double a : {1.0, -1.0}) {
    for (const double b : {g, -g}) {
      mesh.points.push_back(Vec3(0, a, b).normalized());
      mesh.points.push_back(Vec3(a, b, 0).normalized());
      mesh.points.push_back(Vec3(b, 0, a).normalized());
    }
  }
  mesh.triangles = {{0, 2, 1},  {0, 1, 7},  {0, 6, 2},  {0, 5, 6},   {0, 7, 5},
                    {1, 2, 8},  {1, 3, 7},  {1, 8, 3},  {2, 6, 4},   {2, 4, 8},
                    {3, 11, 7}, {3, 8, 9},  {3, 9, 11}, {4, 6, 10},  {4, 9, 8},
                    {4, 10, 9}, {5, 10, 6}, {5, 7, 11}, {5, 11, 10}, {9, 10, 11}};
  refineUnitSphere(mesh, levels);
  mesh.faceOf.assign(mesh.triangles.size(), 0);
  return mesh;
}

/// Torus around the z axis: major radius R, minor radius r, `around` x `across` quads. One face.
inline TriMesh torus(double major, double minor, Index around, Index across) {
  TriMesh mesh;
  for (Index i = 0; i < around; ++i) {
    for (Index j = 0; j < across; ++j) {
      const double u = 2 * std::numbers::pi * i / around;
      const double v = 2 * std::numbers::pi * j / across;
      const double rho = major + minor * std::cos(v);
      mesh.points.emplace_back(rho * std::cos(u), rho * std::sin(u), minor * std::sin(v));
    }
  }
  auto at = [&](Index i, Index j) { return i % around * across + j % across; };
  for (Index i = 0; i < around; ++i) {
    for (Index j = 0; j < across; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  mesh.faceOf.assign(mesh.triangles.size(), 0);
  return mesh;
}

/// Open square sheet [0,1]^2 at z = 0, normal +z, n x n quads, one face; no labels on its border.
inline TriMesh sheet(Index n) {
  TriMesh mesh;
  for (Index j = 0; j <= n; ++j) {
    for (Index i = 0; i <= n; ++i) {
      mesh.points.emplace_back(static_cast<double>(i) / n, static_cast<double>(j) / n, 0);
    }
  }
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) {
      const Index a = j * (n + 1) + i;
      mesh.triangles.push_back({a, a + 1, a + n + 2});
      mesh.triangles.push_back({a, a + n + 2, a + n + 1});
    }
  }
  mesh.faceOf.assign(mesh.triangles.size(), 0);
  return mesh;
}

/// Adds a mesh to another, without labels; `flip` turns it inside out, into a cavity.
inline void append(TriMesh& all, const TriMesh& part, bool flip = false) {
  const auto first = static_cast<Index>(all.points.size());
  all.points.insert(all.points.end(), part.points.begin(), part.points.end());
  for (auto t : part.triangles) {
    if (flip) std::swap(t[1], t[2]);
    all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
}

}  // namespace phront::test
