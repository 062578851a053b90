#include "front/capped_front.h"

namespace phront::facet {

void addFan(TriMesh& mesh, const std::vector<Index>& loop, Index apex) {
  for (std::size_t k = 0; k < loop.size(); ++k) {
    mesh.triangles.push_back({loop[(k + 1) % loop.size()], loop[k], apex});
    mesh.faceOf.push_back(0);
  }
}

Vec3 middleOf(const std::vector<Vec3>& points) {
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : points) middle += p / static_cast<double>(points.size());
  return middle;
}

}  // namespace phront::facet
