// Which tiles a band of phi needs.
#pragma once

#include <vector>

#include "phront/distance_field.h"

namespace phront {

/// Where the nodes of a field lie and which phi it must hold.
struct BandGrid {
  Vec3 origin = Vec3::Zero();
  double spacing = 0;
  double bandMin = 0;
  double bandMax = 0;
  int threads = 0;
  std::int64_t maxNodes = 0;
};

/// A tile that meets the band, with a triangle near it to start queries from.
struct TileSeed {
  GridIndex coordinates{};
  Index triangle = kNone;
};

/// All tiles that hold a node with bandMin <= phi <= bandMax, and some that merely may; sorted by
/// coordinates. On open shells |phi| decides, as the sign jumps beyond the border.
/// Fails with ResourceLimit, Cancelled.
[[nodiscard]] Result<std::vector<TileSeed>> tilesOfBand(const SurfaceDistance& surface,
                                                        const BandGrid& grid,
                                                        const Progress& progress);

}  // namespace phront
