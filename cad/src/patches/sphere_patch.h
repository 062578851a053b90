// Sphere patches: the part of the offset whose feet are a convex vertex.
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <vector>

#include "patches/offset_face.h"
#include "patches/patch_tools.h"

namespace phront::cad {

/// Patch of the sphere of radius |d| round a vertex, bounded by great-circle arcs and by what poles
/// there have opened into; null when the normal cone of the vertex has no inside. `edges`: those at
/// the vertex. `tolerance` mm: patches narrower than it are none.
[[nodiscard]] TopoDS_Face spherePatch(const EdgeTable& table, const std::vector<int>& edges,
                                      const VertexImages& images, int vertex,
                                      const std::vector<TopoDS_Edge>& opened, double radius,
                                      double tolerance, ArcPool& arcs);

}  // namespace phront::cad
