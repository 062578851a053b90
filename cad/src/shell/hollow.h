// A solid without its cavity, where the cavity is known to meet only the openings.
#pragma once

#include <TopoDS_Shape.hxx>
#include <vector>

#include "phront/status.h"

namespace phront::cad {

struct HollowRequest {
  TopoDS_Shape solid;
  std::vector<int> open;                    ///< 0-based planar faces of the solid
  std::vector<TopoDS_Shape> continuations;  ///< solids: all of the cavities that is outside `solid`
  std::vector<TopoDS_Shape> cavities;       ///< solids that touch no face that is not open
  double fuzzy = 0;                         ///< mm, as in General Fuse
};

/// The wall: closed faces as they are, open faces and cavities cut along one another. Only those
/// pairs are intersected, which general Booleans cannot know. May throw, hang or crash with
/// OpenCASCADE: call it in runInChild. Fails with Failed where that does not close.
[[nodiscard]] Result<TopoDS_Shape> hollowOut(const HollowRequest& request);

}  // namespace phront::cad
