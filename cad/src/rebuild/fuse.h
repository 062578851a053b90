// General Fuse of the raw complex.
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <functional>
#include <vector>

#include "phront/status.h"

namespace phront::cad {

/// True when faces i and j of the list must be intersected with one another.
using MayCross = std::function<bool(std::size_t, std::size_t)>;

/// Splits the faces where they cross. `fuzzy` mm, added to the tolerances; 0: none. `mayCross`
/// empty: every pair whose boxes meet is intersected. `cutters`: edges on faces and vertices on
/// edges, cut there, too.
[[nodiscard]] Result<std::vector<TopoDS_Face>> splitFaces(
    const std::vector<TopoDS_Face>& faces, double fuzzy, const MayCross& mayCross = {},
    const std::vector<TopoDS_Shape>& cutters = {});

}  // namespace phront::cad
