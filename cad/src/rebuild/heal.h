// Prepares a body for offsetting: C1 pieces, no closed faces or edges, no apex inside a face.
#pragma once

#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

namespace phront::cad {

struct HealOptions {
  double tolerance = 0;    ///< mm, within which the shape may move
  bool canonical = false;  ///< extrusions and revolutions that are planes, cylinders, ... become so
  bool unify = false;      ///< merge faces that lie on one surface
};

struct HealedShape {
  TopoDS_Shape shape;
  std::vector<std::string> notes;  ///< one sentence per change
};

/// Never fails: a step that does not work is left out and noted.
[[nodiscard]] HealedShape heal(const TopoDS_Shape& body, const HealOptions& options);

}  // namespace phront::cad
