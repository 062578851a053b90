// Triangles across a loop of points in space.
#pragma once

#include <array>
#include <vector>

#include "phront/types.h"

namespace phront::cad {

/// n - 2 triangles over the closed loop, corners in the direction of the loop; none for n < 3.
/// Minimal total area up to a few hundred points, beyond by cutting off the smallest ear.
[[nodiscard]] std::vector<std::array<Index, 3>> triangulateLoop(const std::vector<Vec3>& loop);

}  // namespace phront::cad
