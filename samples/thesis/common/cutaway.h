// Surfaces with the same triangles, one within the other, cut open to see the layers between them.
#pragma once

#include <vector>

#include "phront/tri_mesh.h"

namespace thesis {

/// What lies on the far side of the plane through `onPlane` (its `normal` points to the eye):
/// surface s, whose points are `surfaces[s]`, with face label s, and the cut face of the layer
/// between surfaces s and s + 1 with label surfaces.size() + s.
[[nodiscard]] phront::TriMesh cutaway(const std::vector<std::array<phront::Index, 3>>& triangles,
                                      const std::vector<std::vector<phront::Vec3>>& surfaces,
                                      const phront::Vec3& onPlane, const phront::Vec3& normal);

}  // namespace thesis
