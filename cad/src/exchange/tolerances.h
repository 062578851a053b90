// Tolerances of edges and vertices: what they are said to bridge, and what they do.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <vector>

namespace phront::cad {

/// Largest distance between the edge's curve and its parameter curve on the face; the edge's and
/// its vertices' tolerances are raised to it.
double raiseTolerance(const TopoDS_Edge& edge, const TopoDS_Face& face);

/// Measures every edge against its faces and every vertex against its edges and faces, and raises
/// their tolerances to it. For faces built one by one on shared edges: a later one may have changed
/// what an earlier one was measured with.
void settleTolerances(const std::vector<TopoDS_Face>& faces);

/// Measures the edges and vertices whose tolerance is above `limit` (mm) and lowers it to what they
/// bridge. Changes the shape itself, and nothing where that would make a valid shape invalid.
void lowerTolerances(const TopoDS_Shape& shape, double limit);

}  // namespace phront::cad
