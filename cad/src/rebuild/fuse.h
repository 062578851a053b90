// General Fuse of the raw complex.
#pragma once

#include <TopoDS_Face.hxx>
#include <vector>

#include "phront/status.h"

namespace phront::cad {

/// Splits the faces where they cross. `fuzzy` mm, added to the tolerances; 0: none.
[[nodiscard]] Result<std::vector<TopoDS_Face>> splitFaces(const std::vector<TopoDS_Face>& faces,
                                                          double fuzzy);

}  // namespace phront::cad
