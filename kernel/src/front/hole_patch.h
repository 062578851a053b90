// The part of a front that fills holes of another surface, as a closed mesh.
#pragma once

#include "front/capped_front.h"
#include "phront/facet.h"

namespace phront::facet {

/// Triangles of the front inside the holes, and a band that joins them to the holes' corners, which
/// are the borders.
/// Fails with InvalidArgument (no loop, one of fewer than three corners), ResourceLimit (too many
/// corners), Failed (no triangles join them).
[[nodiscard]] Result<CappedFront> makeHolePatch(const SurfaceDistance& surface,
                                                const IsoSurface& iso, const SurfaceHoles& holes);

}  // namespace phront::facet
