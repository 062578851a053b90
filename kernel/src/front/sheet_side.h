// The part of a front around a sheet that lies over one of its sides.
#pragma once

#include "front/capped_front.h"
#include "phront/surface_distance.h"

namespace phront::facet {

/// `wrap`: phi = |distance| of the sheet's plain distance, closed around it. What stays has its
/// foot within the sheet or straight over a free edge, on the side that `distance` tells by its
/// sign. Empty (no triangles) where nothing does. `tolerance`: of the border's lines.
[[nodiscard]] CappedFront frontBesideSheet(const SurfaceDistance& sheet, const IsoSurface& wrap,
                                           double distance, double tolerance);

}  // namespace phront::facet
