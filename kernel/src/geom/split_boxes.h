// Boxes around long triangles, cut into pieces.
#pragma once

#include <vector>

#include "phront/tri_mesh.h"
#include "phront/types.h"

namespace phront {

/// Boxes that together cover every triangle: one each, several for a triangle whose own box is
/// mostly air. A tree over them finds the same closest points, sooner.
struct TriangleBoxes {
  std::vector<Box3> boxes;
  std::vector<Index> triangle;  ///< that each box belongs to
};

[[nodiscard]] TriangleBoxes splitBoxes(const TriMesh& mesh);

}  // namespace phront
