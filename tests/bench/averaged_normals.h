// Marching along averaged normals: what meshers do that extrude layers without a field.
#pragma once

#include "phront/tri_mesh.h"

namespace phront::bench {

/// The mesh with every point moved by `distance` in equal steps, each along the mean of the normals
/// of its triangles as they are then, weighted by angle.
[[nodiscard]] TriMesh marchAlongAveragedNormals(TriMesh mesh, double distance, int steps);

}  // namespace phront::bench
