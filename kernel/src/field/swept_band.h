// A band of phi by fast sweeping.
#pragma once

#include <vector>

#include "field/tile_descent.h"
#include "phront/surface_distance.h"

namespace phront {

struct SweptTile {
  GridIndex coordinates{};
  BlockPhi block;
};

/// The tiles of the band with the nodes that lie in it, sorted by coordinates. The surface is
/// closed. Fails with ResourceLimit, Cancelled, Failed.
[[nodiscard]] Result<std::vector<SweptTile>> sweptBand(const SurfaceDistance& surface,
                                                       const BandGrid& grid,
                                                       const Progress& progress);

}  // namespace phront
