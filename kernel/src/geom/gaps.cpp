#include "geom/gaps.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "geom/bvh.h"
#include "geom/mesh_topology.h"

namespace phront {
namespace {

struct Rim {
  Vec3 from, to;
  Vec3 along() const { return to - from; }
  double squaredDistance(const Vec3& x) const {
    const double length = along().squaredNorm();
    const double t = length > 0 ? std::clamp(along().dot(x - from) / length, 0.0, 1.0) : 0;
    return (x - from - t * along()).squaredNorm();
  }
};

}  // namespace

bool onlyGaps(const TriMesh& mesh, std::span<const Index> freeSides, double width) {
  std::vector<Rim> rims;
  std::vector<Box3> boxes;
  for (const Index side : freeSides) {
    const auto point = [&](Index p) { return mesh.points[static_cast<std::size_t>(p)]; };
    rims.push_back({point(sideStart(mesh, side)), point(sideEnd(mesh, side))});
    boxes.emplace_back(rims.back().from.cwiseMin(rims.back().to),
                       rims.back().from.cwiseMax(rims.back().to));
  }
  std::vector<Index> all(rims.size());
  std::iota(all.begin(), all.end(), Index{0});
  const Bvh tree(boxes, std::move(all));
  return std::all_of(rims.begin(), rims.end(), [&](const Rim& rim) {
    const Vec3 middle = 0.5 * (rim.from + rim.to);
    bool faced = false;
    tree.nearest(
        middle,
        [&](Index i) {
          const Rim& other =
              rims[static_cast<std::size_t>(tree.order()[static_cast<std::size_t>(i)])];
          faced = faced || (other.along().dot(rim.along()) < 0 &&
                            other.squaredDistance(middle) <= width * width);
        },
        [&] { return faced ? -1.0 : width * width; });
    return faced;
  });
}

}  // namespace phront
