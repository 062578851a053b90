// The openings of a shell: how a solid goes on beyond them, and what lies beyond.
#pragma once

#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "phront/cad/shape.h"
#include "phront/status.h"

namespace phront::cad {

/// Open faces that hang together by edges, and the material that carries on through them.
struct Opening {
  std::vector<int> faces;     ///< 0-based, of the solid
  TopoDS_Shape continuation;  ///< solid: all that lies within `height` straight above the faces
  TopoDS_Shape below;         ///< solid: what lies below the planes of all its faces
};

struct ThroughOpenings {
  TopoDS_Shape solid;  ///< the body with every continuation
  std::vector<Opening> openings;
};

/// Extends a solid by `height` (mm, > 0) through planar faces: prisms that stand on the faces, and
/// sectors between the prisms of neighbours. Below the plane of an opening the distance to the
/// extended solid's boundary is then the distance to the faces that are not open, except beside a
/// face that rises from the opening at 90 degrees or more inside the material: there the prism
/// leans away from it by kDraft, and the distance is too small by at most 1 - cos(kDraft), 0.02 %.
/// `outwards`: the outer side is wanted, too; then neighbours of an opening must turn away from it
/// by 43 degrees or more. `firstNumber`: what the user calls the solid's first face. Fails with
/// NotSupported and a sentence that names the face. May throw, hang or crash with OpenCASCADE: call
/// it in runInChild.
[[nodiscard]] Result<ThroughOpenings> extendThrough(const TopoDS_Shape& solid,
                                                    const std::vector<int>& open, double height,
                                                    bool outwards, int firstNumber);

/// rad
inline constexpr double kDraft = 0.02;

}  // namespace phront::cad
