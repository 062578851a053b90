// Offset faces that leave the front in places: beyond a centre of curvature they fold over.
#pragma once

#include <vector>

#include "rebuild/select.h"
#include "tessellate/true_distance.h"

namespace phront::cad {

/// Share of the live pieces' area, on grids of points, where phi is off the distance by more than
/// 2 % of it. Cheap beside a full check.
[[nodiscard]] double shareOffFront(const std::vector<JudgedFace>& pieces, double distance,
                                   const TrueDistance& phi);

}  // namespace phront::cad
