// phi = d of one body within bounds of time and size.
#pragma once

#include <cstdint>
#include <limits>

#include "phront/iso_surface.h"
#include "phront/progress.h"
#include "phront/status.h"

namespace phront::cad {

struct FrontBounds {
  std::int64_t nodes = 0;  ///< features thinner than the grid are resolved up to so many nodes
  double seconds = 0;
  /// Of triangles at creases, mm, up to the same number of nodes.
  double creaseTolerance = std::numeric_limits<double>::infinity();
};

/// The front `level` of a closed surface. Out of time while it resolves thin features: the front
/// without them, marked `unresolved`. Fails with Cancelled (by the user), ResourceLimit (no front
/// within the time) and what isoSurface fails with.
[[nodiscard]] Result<IsoSurface> makeFront(const SurfaceDistance& surface, double level,
                                           int threads, const FrontBounds& bounds,
                                           const Progress& progress);

}  // namespace phront::cad
