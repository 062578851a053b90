// Arrival times of a front with given speed on a Cartesian grid, in the plane or in space.
#pragma once

#include <span>
#include <vector>

#include "phront/node_grid.h"
#include "phront/progress.h"
#include "phront/status.h"

namespace phront {

enum class EikonalOrder { First, Second };

/// Of the times while they are swept. Single: half the memory and up to twice the speed; a relative
/// error of about 1e-6 beside the scheme's own, which is a part of h. First order only.
enum class EikonalPrecision { Double, Single };

struct EikonalOptions {
  EikonalOrder order = EikonalOrder::First;
  EikonalPrecision precision = EikonalPrecision::Double;
  double tolerance = 1e-9;  ///< times h: changes below it end the iteration; >= 0
  int maxSweeps = 1000;     ///< > 0; together; give up beyond (Failed)
  int threads = 0;          ///< 0: all cores
};

struct EikonalSolution {
  std::vector<double> times;  ///< per node; infinity where the front never comes
  int sweeps = 0;             ///< until nothing changed, the last one included
};

/// Solves speed |grad T| = 1 with T = known[n] where that is finite (>= 0; infinity: unknown), by
/// fast sweeping (Zhao 2005) of the Godunov upwind scheme, one-sided at the walls of the grid.
/// `speed` is per node, > 0, or 0 where the front cannot enter; empty: 1 everywhere, T is the
/// distance. First order: error O(h log h) from exact values around a smooth source. Second order
/// (upwind differences, Sethian 1999): O(h^2) where T is smooth; known values must then reach two
/// nodes from the source, and `speed` must be smooth. The same bits at any number of threads and on
/// every processor. Fails with InvalidArgument (grid, sizes, NaN, negative
/// values, nothing known, second order in single precision), Failed, Cancelled.
[[nodiscard]] Result<EikonalSolution> solveEikonal(const NodeGrid& grid,
                                                   std::span<const double> known,
                                                   std::span<const double> speed,
                                                   const EikonalOptions& options = {},
                                                   const Progress& progress = {});

}  // namespace phront
