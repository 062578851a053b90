// Nodes that must all lie on the same side of the surface.
#pragma once

#include <vector>

#include "phront/distance_field.h"

namespace phront {

/// Neighbouring nodes farther than h/2 from the surface, of one sign.
struct SafeRegion {
  std::vector<Index> tiles;  ///< that hold some of them, each once
  Index tile = kNone;        ///< where the node farthest from the surface is
  int node = -1;             ///< its number there
  double phi = 0;            ///< its value
};

/// All regions of a field with the values `phi`. A ball of radius |phi| around a node holds nothing
/// of the surface, and those of two neighbours farther than h/2 overlap: if one of a region's signs
/// is right, all are. Same regions at any thread count.
[[nodiscard]] std::vector<SafeRegion> safeRegions(const DistanceField& field,
                                                  const std::vector<double>& phi, int threads);

}  // namespace phront
