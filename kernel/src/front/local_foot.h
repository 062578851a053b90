// Feet of one branch of the distance: closest points that stay on their side of the medial axis.
#pragma once

#include <vector>

#include "geom/mesh_topology.h"
#include "phront/surface_distance.h"

namespace phront {

/// Walks over a mesh from triangle to neighbour while the distance falls. Where two parts of the
/// surface are equally near, the global foot jumps; this one stays on the part it started from, so
/// that both distances can be made equal to d at once. Thread safe; allocates nothing.
class LocalFoot {
 public:
  explicit LocalFoot(const SurfaceDistance& surface);

  /// A local minimum of |x - p| over the surface, downhill from the given triangle.
  [[nodiscard]] FootPoint find(const Vec3& x, Index triangle) const;

 private:
  const SurfaceDistance& surface_;
  std::vector<Index> across_;  // per side: triangle on the other side or kNone
  PointRings rings_;
};

}  // namespace phront
