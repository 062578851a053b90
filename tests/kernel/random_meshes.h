// Random closed solids for property tests: unions of boxes, prisms; placed anywhere at any scale.
#pragma once

#include <random>
#include <vector>

#include "meshes.h"
#include "phront/surface_distance.h"

namespace phront::test {

/// Rotates, scales and shifts; orientation is kept.
inline TriMesh placed(TriMesh mesh, const Eigen::Quaterniond& turn, double scale,
                      const Vec3& shift) {
  for (Vec3& p : mesh.points) p = scale * (turn * p) + shift;
  return mesh;
}

inline double uniform(std::mt19937_64& rng, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(rng);
}

inline Eigen::Quaterniond randomTurn(std::mt19937_64& rng) {
  Eigen::Quaterniond turn(uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1),
                          uniform(rng, 0.1, 1));
  return turn.normalized();
}

/// Boundary of the marked cells of a rectilinear grid; one B-Rep face per side of a cell.
inline TriMesh cellUnion(const std::array<std::vector<double>, 3>& planes,
                         const std::vector<bool>& filled) {
  const std::array<Index, 3> n{static_cast<Index>(planes[0].size()) - 1,
                               static_cast<Index>(planes[1].size()) - 1,
                               static_cast<Index>(planes[2].size()) - 1};
  const auto isFilled = [&](const std::array<Index, 3>& c) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (c[a] < 0 || c[a] >= n[a]) return false;
    }
    return bool(filled[static_cast<std::size_t>(c[0] + n[0] * (c[1] + n[1] * c[2]))]);
  };
  TriMesh mesh;
  std::map<std::array<Index, 3>, Index> pointAt;
  const auto point = [&](const std::array<Index, 3>& at) {
    const auto [entry, isNew] = pointAt.try_emplace(at, static_cast<Index>(mesh.points.size()));
    if (isNew) {
      mesh.points.emplace_back(planes[0][static_cast<std::size_t>(at[0])],
                               planes[1][static_cast<std::size_t>(at[1])],
                               planes[2][static_cast<std::size_t>(at[2])]);
    }
    return entry->second;
  };
  Index face = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3;
    const std::size_t c = (a + 2) % 3;
    std::array<Index, 3> cell{};
    for (cell[2] = 0; cell[2] < n[2]; ++cell[2]) {
      for (cell[1] = 0; cell[1] < n[1]; ++cell[1]) {
        for (cell[0] = 0; cell[0] < n[0]; ++cell[0]) {
          for (const Index side : {0, 1}) {
            std::array<Index, 3> next = cell;
            next[a] += 2 * side - 1;
            if (!isFilled(cell) || isFilled(next)) continue;
            std::array<std::array<Index, 3>, 4> corner{cell, cell, cell, cell};
            for (auto& p : corner) p[a] += side;
            ++corner[1][b], ++corner[2][b], ++corner[2][c], ++corner[3][c];
            std::array<Index, 4> q{point(corner[0]), point(corner[1]), point(corner[2]),
                                   point(corner[3])};
            if (side == 0) std::swap(q[1], q[3]);
            mesh.triangles.push_back({q[0], q[1], q[2]});
            mesh.triangles.push_back({q[0], q[2], q[3]});
            mesh.faceOf.insert(mesh.faceOf.end(), 2, face++);
          }
        }
      }
    }
  }
  return mesh;
}

/// Random union of boxes inside about [0,1]^3 that is a closed manifold.
inline TriMesh randomCells(std::mt19937_64& rng, Index perAxis) {
  while (true) {
    std::array<std::vector<double>, 3> planes;
    for (auto& list : planes) {
      list.push_back(0);
      for (Index i = 0; i < perAxis; ++i) list.push_back(list.back() + uniform(rng, 0.2, 1));
      for (double& v : list) v /= list.back() == 0 ? 1 : 0.6 * perAxis;
    }
    std::vector<bool> filled(static_cast<std::size_t>(perAxis * perAxis * perAxis));
    for (std::size_t i = 0; i < filled.size(); ++i) filled[i] = uniform(rng, 0, 1) < 0.6;
    TriMesh mesh = cellUnion(planes, filled);
    if (diagnose(mesh).closedManifold()) return mesh;
  }
}

/// Regular prism with n sides in a circle of radius r, height z.
inline TriMesh regularPrism(Index n, double r, double z) {
  std::vector<std::array<double, 2>> polygon;
  std::vector<std::array<Index, 3>> caps;
  for (Index i = 0; i < n; ++i) {
    const double u = 2 * std::numbers::pi * i / n;
    polygon.push_back({r * std::cos(u), r * std::sin(u)});
    if (i > 1) caps.push_back({0, i - 1, i});
  }
  return prism(polygon, caps, 0, z);
}

}  // namespace phront::test
