// Generalised winding number of a triangle soup, fast for many queries.
#pragma once

#include <span>
#include <vector>

#include "geom/bvh.h"
#include "geom/closest_on_triangle.h"

namespace phront {

/// Far-field moments per node of a Bvh; near triangles are summed exactly.
class WindingTree {
 public:
  WindingTree() = default;
  /// `triangles` in the order of bvh.order().
  WindingTree(const Bvh& bvh, std::span<const QueryTriangle> triangles);

  /// Same Bvh and triangles as at construction.
  [[nodiscard]] double at(const Vec3& x, const Bvh& bvh,
                          std::span<const QueryTriangle> triangles) const;
  /// at() of a closed mesh, rounded: the same whole number, several times sooner.
  [[nodiscard]] int timesAround(const Vec3& x, const Bvh& bvh,
                                std::span<const QueryTriangle> triangles) const;

 private:
  double sum(const Vec3& x, const Bvh& bvh, std::span<const QueryTriangle> triangles,
             double farField) const;

  struct Moment {
    Vec3 centre = Vec3::Zero();  ///< area-weighted
    double radius = 0;           ///< of the ball around it that holds the node's box
    Vec3 dipole = Vec3::Zero();  ///< sum of area x normal
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();  ///< sum of (c_t - centre) (area normal)^T
  };
  std::vector<Moment> moments_;  ///< one per node
};

}  // namespace phront
