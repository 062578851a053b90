// OpenCASCADE's own triangulation of a shape, face by face, as plain data.
#pragma once

#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "phront/cad/tessellate.h"

namespace phront::cad {

/// Numbers of faces, edges and vertices: TopExp::MapShapes's order, from 0.
struct ShapeMaps {
  explicit ShapeMaps(const TopoDS_Shape& shape);
  TopTools_IndexedMapOfShape faces;
  TopTools_IndexedMapOfShape edges;
  TopTools_IndexedMapOfShape vertices;
};

/// One use of an edge by a face: the face's nodes along it, in the direction of the curve.
struct EdgePolygon {
  Index edge = kNone;
  Index firstVertex = kNone;  ///< at nodes.front(); kNone when the edge has none
  Index lastVertex = kNone;
  bool degenerated = false;
  std::vector<Index> nodes;        ///< of the face
  std::vector<double> parameters;  ///< of the 3D curve, per node
};

/// One occurrence of a face in the shape. Triangles run counter-clockwise seen from outside.
struct FaceMesh {
  Index face = kNone;
  std::vector<Vec3> nodes;
  std::vector<Eigen::Vector2d> uv;  ///< per node
  std::vector<std::array<Index, 3>> triangles;
  std::vector<EdgePolygon> polygons;
};

struct ShapeMesh {
  std::vector<FaceMesh> faces;  ///< in the order met in the shape
  std::vector<Index> failed;    ///< faces without triangles
};

/// Triangulates the shape (which then carries the triangulation: call it in a child process or on
/// a copy). Faces that fail are tried again by other means.
[[nodiscard]] ShapeMesh meshShape(const TopoDS_Shape& shape, const ShapeMaps& maps,
                                  double deflection, double angle);

/// Triangulates the faces as they are between the points of their edges alone. Wires that cross
/// themselves, the usual reason why a face gets no triangles, show so, too, at a small part of the
/// cost; what fails inside a face does not. `deflection` mm, of edges; `angle` rad. As above.
void meshOutlines(const TopoDS_Shape& shape, double deflection, double angle);

}  // namespace phront::cad
