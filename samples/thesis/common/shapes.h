// The shapes of the cases.
#pragma once

#include "phront/curve_mesh.h"
#include "phront/tri_mesh.h"

namespace thesis {

/// Counter-clockwise regular polygon with its corners on the circle.
[[nodiscard]] phront::CurveMesh circle(const phront::Vec2& centre, double radius, int sides);

/// Triangles with their corners on a sphere around the origin: an icosahedron, each triangle cut in
/// four `levels` times.
[[nodiscard]] phront::TriMesh sphere(double radius, int levels);

/// Surface of a cube around the origin, each side cut in n x n squares of two triangles; one face
/// label per side.
[[nodiscard]] phront::TriMesh cube(double side, int n);

}  // namespace thesis
