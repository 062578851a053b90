#include "averaged_normals.h"

#include <cmath>

namespace phront::bench {

TriMesh marchAlongAveragedNormals(TriMesh mesh, double distance, int steps) {
  for (int step = 0; step < steps; ++step) {
    std::vector<Vec3> normals(mesh.points.size(), Vec3::Zero());
    for (const auto& t : mesh.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& p = mesh.points[static_cast<std::size_t>(t[k])];
        const Vec3 u = mesh.points[static_cast<std::size_t>(t[(k + 1) % 3])] - p;
        const Vec3 v = mesh.points[static_cast<std::size_t>(t[(k + 2) % 3])] - p;
        const Vec3 normal = u.cross(v);
        const double angle = std::atan2(normal.norm(), u.dot(v));
        normals[static_cast<std::size_t>(t[k])] += angle * normal.normalized();
      }
    }
    for (std::size_t i = 0; i < mesh.points.size(); ++i)
      mesh.points[i] += distance / steps * normals[i].normalized();
  }
  return mesh;
}

}  // namespace phront::bench
