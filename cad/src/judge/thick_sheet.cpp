#include "judge/thick_sheet.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace phront::cad {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();
// Of a height above the border: where the sheet is nearer by more, the wall has ended.
constexpr double kLooseKeep = 1.2e-3;

double beyond(double value, double low, double high) {
  return std::max({low - value, value - high, 0.0});
}

}  // namespace

double ThickSheet::offSides(const TrueDistance::Foot& foot) const {
  if (foot.beyondBorder) return kNone;
  const double height = foot.sign * foot.distance;
  return std::min(std::abs(height - walls_.outer), std::abs(height + walls_.inner));
}

double ThickSheet::offWalls(const Vec3& x, double toSheet) const {
  const std::optional<BorderPoint> b = border_.nearest(x);
  if (!b) return kNone;
  const Vec3 arm = x - b->point;
  const double height = arm.dot(b->normal);
  double least = kNone;
  if (toSheet >= std::abs(height) * (1 - kLooseKeep))
    least =
        std::hypot((arm - height * b->normal).norm(), beyond(height, -walls_.inner, walls_.outer));
  for (const RidgeEnd& end : border_.ridgeEnds()) {
    const Vec3 from = x - end.point;
    const double radius = end.convex ? walls_.outer : walls_.inner;
    const double side = end.convex ? 1 : -1;
    const Vec3 inPlane = from - from.dot(end.tangent) * end.tangent;
    if (toSheet < inPlane.norm() * (1 - kLooseKeep)) continue;
    // Between the two normals: on the inner side of each of them.
    const Vec3 n1 = side * end.normal1;
    const Vec3 n2 = side * end.normal2;
    const Vec3 axis = n1.cross(n2);
    if (axis.dot(n1.cross(inPlane)) < 0 || axis.dot(inPlane.cross(n2)) < 0) continue;
    least = std::min(least, std::hypot(from.dot(end.tangent), beyond(inPlane.norm(), 0, radius)));
  }
  return least;
}

WallPoint ThickSheet::offBoundary(const Vec3& x) const {
  const TrueDistance::Foot foot = phi_.foot(x);
  const double sides = offSides(foot);
  const double walls = offWalls(x, foot.distance);
  return {std::min(sides, walls), sides <= walls};
}

}  // namespace phront::cad
