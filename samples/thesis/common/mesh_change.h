// What became of a mesh whose points were moved.
#pragma once

#include "phront/tri_mesh.h"

namespace thesis {

struct Inverted {
  int triangles = 0;     ///< whose normal turned by more than a right angle
  double areaShare = 0;  ///< of the mesh before
};
/// `after` has the triangles of `before`.
[[nodiscard]] Inverted inverted(const phront::TriMesh& before, const phront::TriMesh& after);

/// Triangles that a side of another one goes through which shares no point with it. Contact within
/// rounding may count or not.
[[nodiscard]] int crossedTriangles(const phront::TriMesh& mesh);

}  // namespace thesis
