// Open tubes made longer and closed.
#pragma once

#include <vector>

#include "phront/tri_mesh.h"

namespace thesis {

/// Free borders, each a closed line of points; the mesh lies to its left, seen from outside.
[[nodiscard]] std::vector<std::vector<phront::Index>> borders(const phront::TriMesh& mesh);

/// `mesh` with a straight piece of `length` put on each free border and closed by a lid: a vessel
/// goes on where its picture ends. Left open, the field bends round the border and points there
/// leave their normals. Points nearer to the mesh than `length` do not feel the lids. Points and
/// triangles of `mesh` come first and stay as they are; labels are dropped.
[[nodiscard]] phront::TriMesh continued(const phront::TriMesh& mesh, double length);

}  // namespace thesis
