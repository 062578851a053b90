// A spline in place of a face's offset surface.
#pragma once

#include <TopoDS_Face.hxx>

namespace phront::cad {

/// Where the face lies on an offset surface, puts it on a spline with the same parameters that is
/// within `tolerance` mm of it all over the face; its edges keep their curves. False, and the face
/// as it was, where there is no offset surface or no such spline: the surface folds, is nowhere
/// smooth enough, or closes on itself.
bool useSpline(const TopoDS_Face& face, double tolerance);

}  // namespace phront::cad
