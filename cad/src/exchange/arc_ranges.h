// Arcs as readers of files expect them: within one turn of their circle.
#pragma once

#include <TopoDS_Shape.hxx>

namespace phront::cad {

/// Turns the circles of edges that cross the zero of their own parameter, so that the
/// edge lies in the middle of [0, 2 pi]; no point moves. A file holds no parameters, only the
/// curve's axes and the end points: a reader that finds the end before the start adds a turn, and
/// OpenCASCADE's takes the edge for another one where the face ends at an apex (V 7.6). Edges whose
/// curves in the faces cannot follow stay as they are. Changes `shape` in place.
void keepArcsWithinOneTurn(const TopoDS_Shape& shape);

}  // namespace phront::cad
