// Images of faces, their edges and their vertices.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "patches/edge_table.h"
#include "patches/patch_tools.h"
#include "patches/vertex_images.h"

namespace phront::cad {

struct FaceImage {
  TopoDS_Face face;  ///< null when the offset surface does not exist, or is in pieces
  std::vector<TopoDS_Face> pieces;  ///< instead of `face`, where the image ends at its axis
  bool inPieces = false;
  bool dead = false;  ///< curvature radius below |d| everywhere: no part of it can be on the offset
  std::map<int, TopoDS_Edge> edges;  ///< by index into EdgeTable::edges, FORWARD
};

/// Offset of every face over its own parameter domain; smooth neighbours share the image edge.
/// `tolerance` bounds the approximation of curves that have no closed form.
[[nodiscard]] std::vector<FaceImage> offsetFaces(const EdgeTable& table,
                                                 const VertexImages& vertices, double distance,
                                                 double tolerance, ArcPool& arcs, PointPool& points,
                                                 std::vector<std::string>& notes);

}  // namespace phront::cad
