// Edges at which facets take over.
#pragma once

#include <TopoDS_Face.hxx>
#include <cstddef>
#include <vector>

namespace phront::cad {

struct StraightenOptions {
  double chord = 0;      ///< mm: how far lines may be off the curves they stand for
  double longest = 0;    ///< mm: longer lines are divided
  double tolerance = 0;  ///< mm: how far lines may be off the face
};

/// Lines in place of each edge that one of the faces uses, once: planar facets beside them then end
/// exactly there. Edges are divided until they are nearly straight; the lines keep the face's
/// parameter curve, and their tolerances say how far they are off it. Gives the faces (by number)
/// with edges that no lines can stand for; these stay as they were.
[[nodiscard]] std::vector<std::size_t> straightenOpenEdges(std::vector<TopoDS_Face>& faces,
                                                           const StraightenOptions& options);

}  // namespace phront::cad
