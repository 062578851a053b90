// The offset of one face: surfaces, trimmed to where the front is.
#pragma once

#include <TopoDS_Face.hxx>
#include <string>
#include <vector>

#include "phront/cad/offset_surfaces.h"
#include "tessellate/true_distance.h"

namespace phront::cad {

struct TrimmedOffset {
  FaceOffset report;
  std::vector<TopoDS_Face> faces;
};

/// Offset surfaces over the domain of `face` (of the shape that `phi` measures), cut along the
/// lines where points of the offset come nearer to the shape than |distance|: there another part of
/// the front, or of the surface itself, is met. What remains has the loops of the face at the same
/// (u,v). `solid`: phi has a sign. Call it in runInChild: OpenCASCADE may throw, hang or crash.
[[nodiscard]] TrimmedOffset offsetTrimmedFace(const TopoDS_Face& face, bool solid, double distance,
                                              double tolerance, const TrueDistance& phi);

}  // namespace phront::cad
