// Solids from faces that share their edges.
#pragma once

#include <TopAbs_ShapeEnum.hxx>
#include <TopoDS_Shape.hxx>
#include <vector>

namespace phront::cad {

/// The parts of one kind, each once.
[[nodiscard]] std::vector<TopoDS_Shape> partsOf(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind);

/// Every solid that the faces enclose, oriented outwards, with its voids. May throw or hang with
/// OpenCASCADE.
[[nodiscard]] std::vector<TopoDS_Shape> cellsOf(const std::vector<TopoDS_Shape>& faces);

}  // namespace phront::cad
