// Brings triangles as near to their faces as was asked for.
#pragma once

#include "tessellate/features.h"
#include "tessellate/soup.h"

namespace phront::cad {

/// Distance of x, a point of a triangle at parameters about `uv`, from the exact surface.
[[nodiscard]] double deviation(const FaceSurface& surface, const Vec3& x, const Eigen::Vector2d& uv,
                               double tolerance);

/// Halves sides whose middle misses its face (or its edge) by more than `deflection` beyond what
/// the ends of the side already do: new points lie on the exact surface or curve. Both triangles of
/// a side are cut alike: a closed mesh stays closed. Triangles that fill holes are left alone.
void refine(Soup& soup, const ShapeIndex& index, double deflection);

}  // namespace phront::cad
