// Cells of a patch: rectangles in (u,v) with what of space they cover.
#pragma once

#include <BRepAdaptor_Surface.hxx>
#include <array>

#include "phront/types.h"

namespace phront::cad {

/// What bulges between the sample points of a cell, in parts of its size.
inline constexpr double kBulge = 0.15;

struct SurfaceCell {
  double u0, u1, v0, v1;
  Box3 box;          ///< of the sample points, without a margin
  Vec3 centre;       ///< the surface's point in the middle of (u,v)
  double reach = 0;  ///< of the sample points from the centre
  bool operator<(const SurfaceCell& other) const { return reach < other.reach; }
};

/// Samples three by three points.
[[nodiscard]] SurfaceCell surfaceCell(const BRepAdaptor_Surface& surface, double u0, double u1,
                                      double v0, double v1);

/// Cut across its longer side.
[[nodiscard]] std::array<SurfaceCell, 2> halves(const BRepAdaptor_Surface& surface,
                                                const SurfaceCell& cell);

[[nodiscard]] Box3 grown(const Box3& box, double by);

}  // namespace phront::cad
