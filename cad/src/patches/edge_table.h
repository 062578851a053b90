// The edges of a healed body, seen from the side the offset lies on.
#pragma once

#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <gp_Pnt.hxx>
#include <gp_Vec.hxx>
#include <vector>

namespace phront::cad {

/// The two faces at one parameter of an edge. Normals point to the offset side.
struct EdgeSample {
  double t = 0;
  gp_Pnt point;
  gp_Vec tangent;  ///< unit, along the curve
  gp_Vec n1;
  gp_Vec n2;
  double angle = 0;  ///< rad, > 0 where convex seen from the offset side

  /// The tangent or its reverse: the axis about which n1 turns to n2.
  [[nodiscard]] gp_Vec axis() const {
    return n1.Crossed(n2).Dot(tangent) > 0 ? tangent : tangent.Reversed();
  }
};

struct EdgeInfo {
  TopoDS_Edge edge;     ///< FORWARD
  int face1 = -1;       ///< indices into EdgeTable::faces
  int face2 = -1;       ///< -1 on a free edge
  bool smooth = false;  ///< normals agree: the two images are one edge
  bool pipe = false;    ///< convex somewhere: the offset has a pipe round it
  double largestAngle = 0;
  std::vector<EdgeSample> samples;  ///< from the first to the last parameter; empty: degenerated
};

struct EdgeTable {
  std::vector<TopoDS_Face> faces;
  TopTools_IndexedMapOfShape faceIndex;  ///< 1-based, same order
  TopTools_IndexedMapOfShape edgeIndex;
  TopTools_IndexedMapOfShape vertexIndex;
  std::vector<EdgeInfo> edges;            ///< order of edgeIndex
  std::vector<std::vector<int>> edgesAt;  ///< by vertex (0-based): indices into `edges`
  int nonManifold = 0;                    ///< edges with more than two faces
};

/// `side` +1: the offset lies on the side of the outward normals; -1: on the other.
/// Edges whose normals differ by less than `smoothAngle` all along are smooth.
[[nodiscard]] EdgeTable makeEdgeTable(const TopoDS_Shape& shape, double side, double smoothAngle);

}  // namespace phront::cad
