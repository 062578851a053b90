// From a soup of triangles that should close to a manifold mesh.
#pragma once

#include <vector>

#include "tessellate/soup.h"

namespace phront::cad {

/// A hole that was filled; its triangles carry its number in `patch` and face kNone.
struct HolePatch {
  std::vector<Index> edges;  ///< B-Rep edge of each side of the hole, kNone inside a face
  std::vector<Index> faces;  ///< face of the triangle across each side
};

/// Removes triangles that cancel each other; fills holes whose border sides all satisfy
/// `mustClose[edge]` (sides on no edge always do); pairs sides of triangles and gives each fan of
/// triangles its own point, so that edges are used twice and points have one fan. Unused points go.
[[nodiscard]] std::vector<HolePatch> closeMesh(Soup& soup, const std::vector<bool>& mustClose);

}  // namespace phront::cad
