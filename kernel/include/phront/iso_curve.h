// Level lines of values on a planar grid: the captured front.
#pragma once

#include <span>

#include "phront/curve_mesh.h"
#include "phront/node_grid.h"
#include "phront/status.h"

namespace phront {

/// The lines where the bilinear interpolation of `values` (one per node, infinity: none) takes
/// `level`, by marching squares; values below the level lie to their left. Points lie on grid
/// edges, linearly interpolated: error O(h^2) where the values are smooth, O(h) across kinks. Lines
/// split, merge and close as the level does; they end only on the walls of the grid and next to
/// nodes without a value. Where two lines meet in one cell its saddle decides (Nielson and Hamann
/// 1991). Points and segments in grid order; curveOf numbers the connected lines in order of their
/// first segment. Fails with InvalidArgument (grid not planar, sizes, NaN).
[[nodiscard]] Result<CurveMesh> isoCurve(const NodeGrid& grid, std::span<const double> values,
                                         double level);

}  // namespace phront
