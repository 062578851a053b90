// A mitre's points are on extended offset faces, but extensions of freeform faces have no measure
// of their own; so near the edges a range of distances is allowed instead. Weak spot: what is wrong
// there by less than the limit passes; making mitres therefore bounds their volume, too.
#include "judge/mitre_reach.h"

#include <algorithm>
#include <cmath>

namespace phront::cad {
namespace {

bool isRounded(EdgeType type, double distance) {
  return type == EdgeType::Mixed || type == (distance > 0 ? EdgeType::Convex : EdgeType::Concave);
}

}  // namespace

MitreReach::MitreReach(const ModelDistance& in, double distance, double limit)
    : reach_(limit * std::abs(distance)) {
  for (std::size_t b = 0; b < in.bodyCount(); ++b) {
    const Tessellation& part = in.body(b).tessellation();
    for (const EdgeSide& side : part.edgeSides) {
      if (!isRounded(part.features.edges[static_cast<std::size_t>(side.edge)].type, distance))
        continue;
      const auto& triangle = part.mesh.triangles[static_cast<std::size_t>(side.triangle)];
      const auto corner = static_cast<std::size_t>(side.side);
      const Vec3& from = part.mesh.points[static_cast<std::size_t>(triangle[corner])];
      const Vec3& to = part.mesh.points[static_cast<std::size_t>(triangle[(corner + 1) % 3])];
      segments_.push_back({from, to - from});
    }
  }
}

bool MitreReach::holds(const Vec3& x) const {
  return std::any_of(segments_.begin(), segments_.end(), [&](const Segment& s) {
    const double length2 = s.along.squaredNorm();
    const double t = length2 > 0 ? std::clamp((x - s.from).dot(s.along) / length2, 0.0, 1.0) : 0.0;
    return (x - s.from - t * s.along).squaredNorm() <= reach_ * reach_;
  });
}

}  // namespace phront::cad
