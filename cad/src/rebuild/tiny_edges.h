// Edges that are points within their tolerance.
#pragma once

#include <TopoDS_Shape.hxx>

namespace phront::cad {

/// The solids without edges that lie within the tolerance of one of their own ends, or of the
/// vertex that other such edges were collapsed into; wires and faces that have no other edges go.
/// The shape as it was where there are none, or where the rest is not valid or not as closed.
[[nodiscard]] TopoDS_Shape withoutTinyEdges(const TopoDS_Shape& shape);

}  // namespace phront::cad
