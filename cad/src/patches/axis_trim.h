// Images of cones and tori that reach across their axis, and caps round open apices.
#pragma once

#include <TopoDS_Face.hxx>
#include <optional>
#include <vector>

#include "patches/edge_table.h"
#include "patches/patch_tools.h"

namespace phront::cad {

class VertexImages;

/// What replaces the plain offset of a face.
struct TrimmedImage {
  std::vector<TopoDS_Face> faces;    ///< empty: all of it lies beyond the axis
  std::vector<TopoDS_Face> caps;     ///< sphere pieces round an apex that has opened
  std::map<int, TopoDS_Edge> edges;  ///< images of the face's edges, by index, FORWARD
};

/// For a cone or torus face that is a rectangle in (u,v) and whose offset crosses the axis or stems
/// from an apex: its part on the original side of the axis. `known`: edges already made by smooth
/// neighbours. nullopt for every other face.
[[nodiscard]] std::optional<TrimmedImage> trimAtAxis(const EdgeTable& table, int face,
                                                     const VertexImages& vertices, double distance,
                                                     double tolerance,
                                                     const std::map<int, TopoDS_Edge>& known,
                                                     ArcPool& arcs, PointPool& points);

}  // namespace phront::cad
