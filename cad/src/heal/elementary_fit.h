// The plane, cylinder, cone, sphere or torus that a set of surface points lies on.
#pragma once

#include <Geom_Surface.hxx>
#include <optional>
#include <span>

#include "phront/types.h"

namespace phront::cad {

struct SurfacePoint {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  ///< unit; either side, the same for all
};

struct ElementaryFit {
  Handle(Geom_Surface) surface;  ///< seam, poles and apex where no points are
  double deviation = 0;          ///< largest distance of a point from it
};

/// The simplest of the five surfaces that all points lie on within `tolerance` (a length, > 0) and
/// whose normals agree with theirs; nullopt when there is none, for fewer than nine points, and
/// where the points reach round the whole surface or to a pole or apex.
[[nodiscard]] std::optional<ElementaryFit> fitElementary(std::span<const SurfacePoint> points,
                                                         double tolerance);

}  // namespace phront::cad
