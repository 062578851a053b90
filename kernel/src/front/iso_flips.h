// Edge flips that let the mesh of an iso-surface follow its creases.
#pragma once

#include "front/iso_triangles.h"

namespace phront {

/// Flips edges that cut across a crease, and the long side of triangles whose corners all lie on
/// one. Keeps a closed manifold one; sequential, so the same at any thread count.
void flipToCreases(const SurfaceDistance& surface, const std::vector<IsoVertex>& vertices,
                   double level, std::vector<Triangle>& triangles);

}  // namespace phront
