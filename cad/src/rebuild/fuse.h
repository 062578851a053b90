// General Fuse of the raw complex.
#pragma once

#include <TopoDS_Face.hxx>
#include <vector>

#include "phront/status.h"

namespace phront::cad {

/// Splits the faces where they cross. `fuzzy` mm, added to the tolerances; 0: none.
[[nodiscard]] Result<std::vector<TopoDS_Face>> splitFaces(const std::vector<TopoDS_Face>& faces,
                                                          double fuzzy);

/// The same, with `settled` faces that nothing crosses set aside: only their edges take part, and
/// they come back, after the pieces of `faces`, with their edges replaced where those were cut or
/// merged.
[[nodiscard]] Result<std::vector<TopoDS_Face>> splitFaces(const std::vector<TopoDS_Face>& faces,
                                                          const std::vector<TopoDS_Face>& settled,
                                                          double fuzzy);

}  // namespace phront::cad
