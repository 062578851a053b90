// Points of a face to fit surfaces to.
#pragma once

#include <TopoDS_Face.hxx>
#include <vector>

#include "heal/elementary_fit.h"

namespace phront::cad {

/// Inside, some per knot span, and along the border. The normals are its surface's, whatever its
/// orientation.
[[nodiscard]] std::vector<SurfacePoint> samplesOf(const TopoDS_Face& face);

}  // namespace phront::cad
