// Solids from faces that share their edges.
#pragma once

#include <TopAbs_ShapeEnum.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <vector>

namespace phront::cad {

/// The parts of one kind, each once.
[[nodiscard]] std::vector<TopoDS_Shape> partsOf(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind);

/// Every solid that the faces enclose, oriented outwards, with its voids. May throw or hang with
/// OpenCASCADE.
[[nodiscard]] std::vector<TopoDS_Shape> cellsOf(const std::vector<TopoDS_Shape>& faces);

/// Faces that bound the cell; others end inside of it.
[[nodiscard]] std::vector<TopoDS_Face> wallsOf(const TopoDS_Shape& cell);

/// What bounds the cells together: faces that bound exactly one of them, as that cell has them.
[[nodiscard]] std::vector<TopoDS_Face> skinOf(const std::vector<TopoDS_Shape>& cells);

/// The faces, the largest of each connected set first and each other behind one that it shares an
/// edge with: readers put shells together face by face, and need many passes over another order.
[[nodiscard]] std::vector<TopoDS_Face> inReadingOrder(const std::vector<TopoDS_Face>& faces);

/// The solid with the faces of its shells in that order.
[[nodiscard]] TopoDS_Shape solidInReadingOrder(const TopoDS_Shape& solid);

/// Edges (degenerated ones aside) that their shell does not use exactly twice.
[[nodiscard]] int countOpenEdges(const TopoDS_Shape& shape);

}  // namespace phront::cad
