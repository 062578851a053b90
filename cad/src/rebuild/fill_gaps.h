// Small holes in an otherwise complete set of pieces: closed by fitted patches on phi = d.
#pragma once

#include <TopoDS_Face.hxx>
#include <vector>

#include "tessellate/true_distance.h"

namespace phront::cad {

struct GapOptions {
  double distance = 0;   ///< mm, signed: the level
  double tolerance = 0;  ///< mm, how well a patch has to meet the edges around it
};

struct FilledGaps {
  std::vector<TopoDS_Face> patches;
  double sewing = 0;  ///< mm, closes the slits that are too thin for a patch; 0: there are none
  int unfilled = 0;   ///< loops of open edges that no patch could be made for
};

/// One patch for each closed loop of edges that the faces use once, through points of phi = d
/// inside it. The patches may have edges of their own, to be sewn to the faces. Loops far off the
/// level are left open. May throw, hang or crash with OpenCASCADE.
[[nodiscard]] FilledGaps fillGaps(const std::vector<TopoDS_Face>& faces, const GapOptions& options,
                                  const TrueDistance& phi);

}  // namespace phront::cad
