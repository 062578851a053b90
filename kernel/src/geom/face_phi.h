// Signed distances of neighbouring nodes to the face of one triangle.
#pragma once

#include <array>

#include "geom/block_query.h"
#include "geom/closest_on_triangle.h"

namespace phront {

struct FacePhi {
  std::array<double, 8> squared;  ///< distance to the foot
  std::array<double, 8> height;   ///< above the face: its sign is that of phi
  unsigned over = 0;              ///< bit c: the foot of node c lies inside the face
};

/// Of the nodes BlockQuery::nodeOf(corner, 0 .. 7): the bits of closestOnTriangle for each. `t` is
/// well shaped.
[[nodiscard]] FacePhi facePhi(const QueryTriangle& t, const NodeBlock& block,
                              const std::array<int, 3>& corner);

}  // namespace phront
