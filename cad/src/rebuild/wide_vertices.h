// Vertices whose tolerance bridges what their edges do not reach.
#pragma once

#include <TopoDS_Shape.hxx>

namespace phront::cad {

/// The solids with the edges at every vertex of a tolerance above `limit` (mm, > 0) drawn out to
/// one point that lies on the faces around it, where that at least halves the tolerance needed. The
/// shape as it was where there are none, or where the rest is not valid.
[[nodiscard]] TopoDS_Shape withNarrowVertices(const TopoDS_Shape& shape, double limit);

}  // namespace phront::cad
