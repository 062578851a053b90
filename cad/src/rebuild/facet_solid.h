// A faceted surface as a B-Rep solid of planar faces.
#pragma once

#include <TopoDS_Shape.hxx>

#include "phront/facet.h"
#include "phront/status.h"

namespace phront::cad {

/// One planar face per polygon, shared edges and vertices, one shell per component, cavities put
/// into the solid around them. Returns a solid, or a compound of several. Vertex tolerances cover
/// the measured non-planarity. Fails with Failed when the polygons do not close.
[[nodiscard]] Result<TopoDS_Shape> solidOfFacets(const FacetedSurface& facets);

}  // namespace phront::cad
