// The solid that a sheet becomes when it is given a thickness: where its boundary belongs.
#pragma once

#include "judge/wall_verdict.h"
#include "tessellate/free_border.h"
#include "tessellate/true_distance.h"

namespace phront::cad {

/// All p + h n, p on the sheet, n its normal there, -inner <= h <= outer, p the point of the sheet
/// nearest to it; rounded about edges that are convex on a side. Its boundary: the two sides, and
/// the walls that stand on the free edges. Not thread safe.
class ThickSheet {
 public:
  ThickSheet(const TrueDistance& phi, const FreeBorder& border, const ShellWalls& walls)
      : phi_(phi), border_(border), walls_(walls) {}

  /// Of the far side: one of the two sides, not a wall on the border.
  [[nodiscard]] WallPoint offBoundary(const Vec3& x) const;

 private:
  [[nodiscard]] double offSides(const TrueDistance::Foot& foot) const;
  [[nodiscard]] double offWalls(const Vec3& x, double toSheet) const;

  const TrueDistance& phi_;
  const FreeBorder& border_;
  ShellWalls walls_;
};

}  // namespace phront::cad
