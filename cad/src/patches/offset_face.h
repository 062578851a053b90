// Images of faces, their edges and their vertices.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "patches/edge_table.h"
#include "patches/patch_tools.h"

namespace phront::cad {

struct FaceImage {
  TopoDS_Face face;  ///< null when the offset surface does not exist, or is in pieces
  std::vector<TopoDS_Face> pieces;  ///< instead of `face`, where the image ends at its axis
  bool inPieces = false;
  bool dead = false;  ///< curvature radius below |d| everywhere: no part of it can be on the offset
  std::map<int, TopoDS_Edge> edges;  ///< by index into EdgeTable::edges, FORWARD
};

/// Vertices at V + d n, one per direction: faces that agree in their normal at V share it.
class VertexImages {
 public:
  VertexImages(const EdgeTable& table, double distance, double smoothAngle);

  /// Null where the face has no single normal (apex, pole).
  [[nodiscard]] TopoDS_Vertex image(int vertex, int face) const;
  [[nodiscard]] TopoDS_Vertex image(const TopoDS_Vertex& vertex, int face) const;

 private:
  const EdgeTable& table_;
  std::map<std::pair<int, int>, TopoDS_Vertex> images_;  ///< (vertex, face)
};

/// Offset of every face over its own parameter domain; smooth neighbours share the image edge.
/// `tolerance` bounds the approximation of curves that have no closed form.
[[nodiscard]] std::vector<FaceImage> offsetFaces(const EdgeTable& table,
                                                 const VertexImages& vertices, double distance,
                                                 double tolerance, ArcPool& arcs, PointPool& points,
                                                 std::vector<std::string>& notes);

}  // namespace phront::cad
