// Shapes as bytes, to cross a process border. Exact: doubles are binary.
#pragma once

#include <TopoDS_Shape.hxx>
#include <string>
#include <string_view>

#include "phront/status.h"

namespace phront::cad {

[[nodiscard]] std::string bytesOfShape(const TopoDS_Shape& shape);  ///< without triangulations
[[nodiscard]] Result<TopoDS_Shape> shapeOfBytes(std::string_view bytes);

}  // namespace phront::cad
