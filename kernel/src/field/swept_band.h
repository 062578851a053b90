// A band of phi by fast sweeping.
#pragma once

#include <functional>

#include "field/tile_descent.h"
#include "phront/surface_distance.h"

namespace phront {

/// Gets a tile with its nodes that lie in the band.
using TakeTile = std::function<void(const GridIndex& tile, const BlockPhi& block)>;

/// Sweeps, then hands over the tiles, sorted by coordinates. The surface is closed. Fails with
/// ResourceLimit, Cancelled, Failed.
[[nodiscard]] Result<void> sweepBand(const SurfaceDistance& surface, const BandGrid& grid,
                                     const TakeTile& take, const Progress& progress);

}  // namespace phront
