// A faceted surface as planar faces of a B-Rep.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <vector>

#include "phront/facet.h"
#include "phront/status.h"

namespace phront::cad {

/// One planar face per polygon, shared edges and vertices, one shell per component, cavities put
/// into the solid around them. Returns a solid, or a compound of several. Vertex tolerances cover
/// the measured non-planarity. Fails with Failed when the polygons do not close.
[[nodiscard]] Result<TopoDS_Shape> solidOfFacets(const FacetedSurface& facets);

/// The same for a surface with free sides: a shell per component, or a compound of several.
[[nodiscard]] Result<TopoDS_Shape> sheetOfFacets(const FacetedSurface& facets);

/// One planar face per polygon of a surface with borders, shared edges and vertices; sides of the
/// borders become the edges given. `borders`: closed loops of edges, one behind the other, oriented
/// along the loop; the surface's first points are their first vertices in that order. Fails with
/// Failed when polygons do not close between the borders. Tolerances are those of exact sides.
[[nodiscard]] Result<std::vector<TopoDS_Face>> facesOfFacets(
    const FacetedSurface& facets, const std::vector<std::vector<TopoDS_Edge>>& borders);

}  // namespace phront::cad
