#include "common/continued.h"

#include <map>
#include <utility>

namespace thesis {

using phront::Index;
using phront::TriMesh;
using phront::Vec3;

namespace {

struct FreeSide {
  Index end = phront::kNone;
  Vec3 outward = Vec3::Zero();  // off the mesh, in the plane of the triangle; as long as the side
};

/// By start point.
std::map<Index, FreeSide> freeSides(const TriMesh& mesh) {
  std::map<std::pair<Index, Index>, Index> third;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) third[{t[k], t[(k + 1) % 3]}] = t[(k + 2) % 3];
  }
  const auto at = [&](Index i) { return mesh.points[static_cast<std::size_t>(i)]; };
  std::map<Index, FreeSide> sides;
  for (const auto& [side, opposite] : third) {
    const auto [a, b] = side;
    if (third.contains({b, a})) continue;
    const Vec3 along = at(b) - at(a);
    const Vec3 normal = along.cross(at(opposite) - at(a)).normalized();
    sides[a] = {b, along.cross(normal)};
  }
  return sides;
}

struct Border {
  std::vector<Index> points;
  Vec3 outward = Vec3::Zero();  // mean over the sides: the axis of a tube that is cut across
};

std::vector<Border> findBorders(const TriMesh& mesh) {
  std::map<Index, FreeSide> sides = freeSides(mesh);
  std::vector<Border> found;
  while (!sides.empty()) {
    Border border;
    for (auto side = sides.begin(); side != sides.end();) {
      border.points.push_back(side->first);
      border.outward += side->second.outward;
      const Index end = side->second.end;
      sides.erase(side);
      side = sides.find(end);
    }
    border.outward.normalize();
    found.push_back(std::move(border));
  }
  return found;
}

}  // namespace

std::vector<std::vector<Index>> borders(const TriMesh& mesh) {
  std::vector<std::vector<Index>> lines;
  for (Border& border : findBorders(mesh)) lines.push_back(std::move(border.points));
  return lines;
}

TriMesh continued(const TriMesh& mesh, double length) {
  TriMesh longer;
  longer.points = mesh.points;
  longer.triangles = mesh.triangles;
  for (const Border& border : findBorders(mesh)) {
    const auto first = static_cast<Index>(longer.points.size());
    const auto count = static_cast<Index>(border.points.size());
    Vec3 middle = Vec3::Zero();
    for (const Index p : border.points) {
      longer.points.emplace_back(mesh.points[static_cast<std::size_t>(p)] +
                                 length * border.outward);
      middle += longer.points.back() / count;
    }
    longer.points.push_back(middle);
    for (Index k = 0; k < count; ++k) {
      const Index l = (k + 1) % count;
      const Index p = border.points[static_cast<std::size_t>(k)];
      const Index q = border.points[static_cast<std::size_t>(l)];
      longer.triangles.push_back({q, p, first + k});
      longer.triangles.push_back({q, first + k, first + l});
      longer.triangles.push_back({first + l, first + k, first + count});
    }
  }
  return longer;
}

}  // namespace thesis
