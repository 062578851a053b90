// Pipes round the mouth of a narrow hole in a curved wall.
#pragma once

#include <TopoDS_Face.hxx>
#include <vector>

#include "patches/patch_tools.h"
#include "patches/pipe.h"

namespace phront::cad {

struct MouthEdge {
  PipeFrame frame;
  bool forward = true;  ///< whether the half of the rim runs as the edge does
};

/// Pipes round a rim so narrow that those of its halves meet all along, cut off where they meet.
/// Both halves run from the one tip (see RimTips) to the other. Empty when the pipes are not such;
/// may throw Standard_Failure.
[[nodiscard]] std::vector<TopoDS_Face> mouthPipes(const std::vector<MouthEdge>& one,
                                                  const std::vector<MouthEdge>& other,
                                                  ArcPool& arcs);

}  // namespace phront::cad
