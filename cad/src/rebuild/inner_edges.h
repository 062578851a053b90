// Edges inside of a face.
#pragma once

#include <TopoDS_Face.hxx>

namespace phront::cad {

/// The face without edges that bound nothing: internal ones, and those, seams aside, that it passes
/// once in either direction. As it was where there are none, or where the rest makes no loops.
[[nodiscard]] TopoDS_Face withoutInnerEdges(const TopoDS_Face& face);

}  // namespace phront::cad
