// Free edges that face one another: the surface is closed but for narrow gaps.
#pragma once

#include <span>

#include "phront/tri_mesh.h"

namespace phront {

/// Does every free side have another one within `width` (model units) of its middle that runs the
/// other way, with nothing of its own triangle between? Cracks and small holes do, the rims of
/// openings and of sheets, small ones too, do not. Sides are numbered
/// 3 t + k, from corner k to k + 1.
[[nodiscard]] bool onlyGaps(const TriMesh& mesh, std::span<const Index> freeSides, double width);

}  // namespace phront
