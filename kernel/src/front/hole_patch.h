// The part of a front that fills holes of another surface, as a closed mesh.
#pragma once

#include "phront/facet.h"
#include "phront/iso_surface.h"

namespace phront::facet {

/// Triangles of the front inside the holes, a band that joins them to the holes' corners, and over
/// each loop, from the other side, a fan with an apex of its own. The fans are there so that every
/// stage sees a closed manifold.
struct HolePatch {
  IsoSurface iso;  ///< points: apexes, then corners of the loops, then the others
  Index apexes = 0;
  Index fixedPoints = 0;  ///< apexes and corners
};

/// Fails with InvalidArgument (no loop, one of fewer than three corners), ResourceLimit (too many
/// corners), Failed (no triangles join them).
[[nodiscard]] Result<HolePatch> makeHolePatch(const SurfaceDistance& surface, const IsoSurface& iso,
                                              const SurfaceHoles& holes);

}  // namespace phront::facet
