// The offset of one face: surfaces, trimmed to where the front is.
#pragma once

#include <TopoDS_Face.hxx>
#include <string>
#include <vector>

#include "phront/cad/offset_surfaces.h"
#include "surfaces/piece_trim.h"
#include "tessellate/true_distance.h"

namespace phront::cad {

struct TrimmedOffset {
  FaceOffset report;
  std::vector<TopoDS_Face> faces;
};

/// Offset surfaces over the domain of `face` (of the shape that `phi` measures), cut along the
/// lines where points of the offset come nearer to the shape than |d|: there another part of
/// the front, or of the surface itself, is met. What remains has the loops of the face at the same
/// (u,v). Call it in runInChild: OpenCASCADE may throw, hang or crash.
[[nodiscard]] TrimmedOffset offsetTrimmedFace(const TopoDS_Face& face, const TrimRequest& request,
                                              const TrueDistance& phi);

}  // namespace phront::cad
