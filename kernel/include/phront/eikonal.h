// Arrival times of a front with given speed on a Cartesian grid, in the plane or in space.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "phront/progress.h"
#include "phront/status.h"
#include "phront/types.h"

namespace phront {

/// Node (i,j,k) lies at origin + spacing (i,j,k); nodes are numbered with x fastest.
struct NodeGrid {
  std::array<std::int32_t, 3> nodes{};  ///< per axis, > 0; nodes[2] == 1: a problem in the plane
  double spacing = 0;                   ///< h > 0, model units
  Vec3 origin = Vec3::Zero();

  [[nodiscard]] bool planar() const { return nodes[2] == 1; }
  [[nodiscard]] std::int64_t nodeCount() const {
    return static_cast<std::int64_t>(nodes[0]) * nodes[1] * nodes[2];
  }
  [[nodiscard]] std::int64_t number(std::int32_t i, std::int32_t j, std::int32_t k = 0) const {
    return (static_cast<std::int64_t>(k) * nodes[1] + j) * nodes[0] + i;
  }
  [[nodiscard]] Vec3 position(std::int32_t i, std::int32_t j, std::int32_t k = 0) const {
    return origin + spacing * Vec3(i, j, k);
  }
};

enum class EikonalOrder { First, Second };

struct EikonalOptions {
  EikonalOrder order = EikonalOrder::First;
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
/// every processor. Fails with InvalidArgument (sizes, NaN, negative values, nothing known),
/// Failed, Cancelled.
[[nodiscard]] Result<EikonalSolution> solveEikonal(const NodeGrid& grid,
                                                   std::span<const double> known,
                                                   std::span<const double> speed,
                                                   const EikonalOptions& options = {},
                                                   const Progress& progress = {});

}  // namespace phront
