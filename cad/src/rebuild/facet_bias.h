// From facets of the triangles' offset to facets of the part's offset.
#pragma once

#include "phront/facet.h"
#include "tessellate/true_distance.h"

namespace phront::cad {

/// Facets are made at distance d of the triangles, which lie inside of convex faces and outside of
/// concave ones. Moves every point that no polygon of a plane holds by what the triangles are off
/// the exact shape there; planes are exact as they are, and the first `fixedPoints` stay.
/// `distance` in mm, signed.
void removeChordalBias(FacetedSurface& facets, Index fixedPoints, double distance,
                       const TrueDistance& phi);

}  // namespace phront::cad
