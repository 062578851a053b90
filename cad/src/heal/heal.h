// Prepares a body for offsetting: C1 pieces, no closed faces or edges, no apex inside a face.
#pragma once

#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

namespace phront::cad {

struct HealOptions {
  double tolerance = 0;  ///< mm, within which the shape may move
  bool unify = false;    ///< merge faces that lie on one surface
};

struct HealedShape {
  TopoDS_Shape shape;
  std::vector<std::string> notes;  ///< one sentence per change
};

/// Freeform faces that are planes, cylinders, cones, spheres or tori within `tolerance` (mm) become
/// so. Without notes: nothing was found, and the shape is the body itself. Never fails; may crash
/// or hang with OpenCASCADE.
[[nodiscard]] HealedShape makeElementary(const TopoDS_Shape& body, double tolerance);

/// Never fails: a step that does not work is left out and noted.
[[nodiscard]] HealedShape heal(const TopoDS_Shape& body, const HealOptions& options);

}  // namespace phront::cad
