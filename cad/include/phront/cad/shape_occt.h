// Opt-in: the OpenCASCADE shape behind cad::Shape.
#pragma once

#include <TopoDS_Shape.hxx>

#include "phront/cad/shape.h"

namespace phront::cad {

struct Shape::Impl {
  TopoDS_Shape shape;
};

[[nodiscard]] Shape makeShape(TopoDS_Shape shape);          ///< empty Shape for a null one
[[nodiscard]] const TopoDS_Shape& occtShape(const Shape& shape);  ///< null shape for an empty one

}  // namespace phront::cad
