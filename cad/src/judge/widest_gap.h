// How far apart faces are where they are said to meet.
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <gp_Pnt2d.hxx>
#include <vector>

#include "phront/types.h"

namespace phront::cad {

struct WidestGap {
  double width = 0;  ///< mm
  Vec3 at = Vec3::Zero();
};

/// Measured, since a tolerance is but a bound: the largest distance from an edge to its curves on
/// its faces, and from a vertex to the ends of its edges and of those curves. An edge whose curves
/// do not run side by side counts with its tolerance. May throw with OpenCASCADE on a bad shape.
[[nodiscard]] WidestGap widestGap(const TopoDS_Shape& shape);

struct FaceGap {
  gp_Pnt2d onFace;   ///< parameters of the face's end of the gap
  double width = 0;  ///< mm
  Vec3 at = Vec3::Zero();
};

/// Places of a face's boundary with gaps wider than `limit` (mm), measured in the same way.
[[nodiscard]] std::vector<FaceGap> gapsOf(const TopoDS_Face& face, double limit);

}  // namespace phront::cad
