// Advection of points along the gradient of values on a grid: the scheme of the thesis.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "phront/advect.h"
#include "phront/node_grid.h"
#include "phront/status.h"

namespace phront {

struct GridAdvectOptions {
  double distance = 0;  ///< d, signed, finite, not zero: the level to reach
  /// Length of a step, model units; automatic: half a cell, less where the gradient turns.
  std::optional<double> step = std::nullopt;
  int threads = 0;  ///< 0: all cores
};

/// Moves points along +grad phi (d > 0) or -grad phi (d < 0) of signed values `phi` (one per node,
/// infinity: none) until phi = d. Gradient by central differences (one-sided at walls), both
/// interpolated multilinearly, steps by the classical Runge-Kutta scheme of fourth order; the last
/// one is cut back linearly to the level. A point stops (Collided) where phi no longer comes nearer
/// to d: it has met another front; and (Border) where it would leave the grid. In a planar grid z
/// stays. Position error: that of the grid's gradient, O(h) near edges of the surface, whatever the
/// step. `travelled` is |phi| reached. Points keep their number, so connectivity is carried along.
/// Fails with InvalidArgument (sizes, NaN, d = 0).
[[nodiscard]] Result<AdvectResult> advectOnGrid(const NodeGrid& grid, std::span<const double> phi,
                                                std::span<const Vec3> start,
                                                const GridAdvectOptions& options);

}  // namespace phront
