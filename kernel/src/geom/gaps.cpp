#include "geom/gaps.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "geom/bvh.h"
#include "geom/mesh_topology.h"

namespace phront {
namespace {

constexpr double kOverlap = 0.1;  // of a triangle's height: sheets may overlap a little at a crack

struct Rim {
  Vec3 from, to;
  Vec3 outward;  ///< in the triangle's plane, as long as the triangle is high

  [[nodiscard]] Vec3 along() const { return to - from; }
  [[nodiscard]] Vec3 middle() const { return 0.5 * (from + to); }
  [[nodiscard]] Vec3 closest(const Vec3& x) const {
    const double length = along().squaredNorm();
    const double t = length > 0 ? std::clamp(along().dot(x - from) / length, 0.0, 1.0) : 0;
    return from + t * along();
  }
  /// Is the other one across a gap: before this one, not behind its triangle?
  [[nodiscard]] bool faces(const Rim& other, double width) const {
    const Vec3 across = other.closest(middle()) - middle();
    return other.along().dot(along()) < 0 && across.norm() <= width &&
           across.dot(outward) >= -kOverlap * outward.squaredNorm();
  }
};

Rim rimOf(const TriMesh& mesh, Index side) {
  const auto& corners = mesh.triangles[static_cast<std::size_t>(side / 3)];
  const auto point = [&](Index p) { return mesh.points[static_cast<std::size_t>(p)]; };
  Rim rim{point(sideStart(mesh, side)), point(sideEnd(mesh, side)), Vec3::Zero()};
  const Vec3 apex = point(corners[static_cast<std::size_t>((side % 3 + 2) % 3)]);
  const double length = rim.along().squaredNorm();
  rim.outward = rim.from - apex;
  if (length > 0) rim.outward -= rim.outward.dot(rim.along()) / length * rim.along();
  return rim;
}

}  // namespace

bool onlyGaps(const TriMesh& mesh, std::span<const Index> freeSides, double width) {
  std::vector<Rim> rims;
  std::vector<Box3> boxes;
  for (const Index side : freeSides) {
    const Rim rim = rimOf(mesh, side);
    rims.push_back(rim);
    boxes.emplace_back(rim.from.cwiseMin(rim.to), rim.from.cwiseMax(rim.to));
  }
  std::vector<Index> all(rims.size());
  std::iota(all.begin(), all.end(), Index{0});
  const Bvh tree(boxes, std::move(all));
  return std::all_of(rims.begin(), rims.end(), [&](const Rim& rim) {
    bool faced = false;
    tree.nearest(
        rim.middle(),
        [&](Index i) {
          const Index number = tree.order()[static_cast<std::size_t>(i)];
          faced = faced || rim.faces(rims[static_cast<std::size_t>(number)], width);
        },
        [&] { return faced ? -1.0 : width * width; });
    return faced;
  });
}

}  // namespace phront
