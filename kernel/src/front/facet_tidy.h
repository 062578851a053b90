// Facets without sides or heights too small for a B-Rep.
#pragma once

#include "phront/facet.h"

namespace phront::facet {

/// Contracts sides shorter than `floor` and gives triangles flatter than `floor` to the facet
/// beyond their longest side. Keeps the surface closed; what cannot go without opening it stays.
void tidyFacets(FacetedSurface& surface, double floor);

}  // namespace phront::facet
