// The distance of a facet's point from d is wanted (it floats so that the facets around it lie as
// much too far as too near), so the point is moved by the difference of the two distances, not to
// the level. Weak spot: at a crease the nearest foot changes; there the move is right for one side.
#include "rebuild/facet_bias.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace phront::cad {
namespace {

// Larger differences are feet gone astray, not chords: of |d|.
constexpr double kMostBias = 0.02;

std::vector<bool> pointsOfPlanes(const FacetedSurface& facets, const TrueDistance& phi) {
  const std::vector<FaceFeature>& faces = phi.tessellation().features.faces;
  std::vector<bool> held(facets.points.size(), false);
  for (const FacetPolygon& polygon : facets.polygons) {
    const bool ofPlane = polygon.feature.kind == FeatureKind::Face &&
                         faces[static_cast<std::size_t>(polygon.feature.id)].plane.has_value();
    if (!ofPlane && polygon.loops.size() == 1 && polygon.loops.front().size() == 3) continue;
    for (const auto& loop : polygon.loops) {
      for (const Index p : loop) held[static_cast<std::size_t>(p)] = true;
    }
  }
  return held;
}

void planeThroughCorners(const FacetedSurface& facets, FacetPolygon& polygon) {
  const auto corner = [&](std::size_t k) -> const Vec3& {
    return facets.points[static_cast<std::size_t>(polygon.loops.front()[k])];
  };
  const Vec3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
  if (!(normal.norm() > 0)) return;
  polygon.plane.normal = normal.normalized();
  polygon.plane.offset = polygon.plane.normal.dot((corner(0) + corner(1) + corner(2)) / 3);
}

}  // namespace

void removeChordalBias(FacetedSurface& facets, Index fixedPoints, double distance,
                       const TrueDistance& phi) {
  std::vector<bool> held = pointsOfPlanes(facets, phi);
  std::fill_n(held.begin(), fixedPoints, true);
  for (std::size_t i = 0; i < facets.points.size(); ++i) {
    if (held[i]) continue;
    Vec3& x = facets.points[i];
    const TrueDistance::Foot foot = phi.foot(x);
    const double bias = foot.distance - foot.meshDistance;
    if (!(foot.distance > 0) || std::abs(bias) > kMostBias * std::abs(distance)) continue;
    x -= bias * (x - foot.point) / foot.distance;
  }
  for (FacetPolygon& polygon : facets.polygons) {
    if (polygon.loops.size() != 1 || polygon.loops.front().size() != 3) continue;
    bool moved = false;
    for (const Index p : polygon.loops.front()) moved = moved || !held[static_cast<std::size_t>(p)];
    if (moved) planeThroughCorners(facets, polygon);
  }
}

}  // namespace phront::cad
