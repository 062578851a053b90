// What closes the rim of a thickened sheet: walls that stand on its free edges.
#pragma once

#include <TopoDS_Face.hxx>
#include <vector>

#include "judge/check_shell.h"
#include "phront/status.h"
#include "tessellate/free_border.h"

namespace phront::cad {

/// Along every free edge the face of all b + h n(b), b on the edge, n the normal of its face there,
/// h from -walls.inner to walls.outer; and where an edge that is convex on a side ends at the
/// border, the sector between the walls of its two faces. Planes, cylinders and cones are made as
/// such, the rest are ruled surfaces good to `tolerance` (mm). Walls of faces that meet at a
/// concave edge cross one another. Fails with Failed where a normal or a surface does not exist;
/// may throw, hang or crash with OpenCASCADE.
[[nodiscard]] Result<std::vector<TopoDS_Face>> sheetWalls(const FreeBorder& border,
                                                          const ShellWalls& walls,
                                                          double tolerance);

}  // namespace phront::cad
