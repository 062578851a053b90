// Pipes: the part of the offset whose feet lie on a convex edge.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <optional>
#include <vector>

#include "patches/edge_table.h"
#include "patches/patch_tools.h"

namespace phront::cad {

/// What a pipe is built between. `image1`, `image2` may be null: they are then made anew.
struct PipeFrame {
  const EdgeInfo* info = nullptr;
  double radius = 0;     ///< |d|
  double tolerance = 0;  ///< mm, approximation
  TopoDS_Edge image1;
  TopoDS_Edge image2;
  TopoDS_Vertex first1;  ///< images of the edge's first vertex in face 1 and 2
  TopoDS_Vertex first2;
  TopoDS_Vertex last1;
  TopoDS_Vertex last2;

  /// Whether both images are there and run as the edge does.
  [[nodiscard]] bool runsAlong() const;
};

/// Piece of a cylinder round a straight edge with constant normals; nullopt when it is not one.
[[nodiscard]] std::optional<std::vector<TopoDS_Face>> linePipe(const PipeFrame& frame,
                                                               ArcPool& arcs);

/// Pieces of a torus round a circular edge with constant normals, cut at the apex when the edge's
/// radius is below |d|; empty list when nothing is left; nullopt when it is no such edge.
[[nodiscard]] std::optional<std::vector<TopoDS_Face>> circlePipe(const PipeFrame& frame,
                                                                 ArcPool& arcs, PointPool& apices);

/// Swept surface round any other edge with both images. Throws Standard_Failure when there is none.
[[nodiscard]] TopoDS_Face sweptPipe(const PipeFrame& frame, ArcPool& arcs);

}  // namespace phront::cad
