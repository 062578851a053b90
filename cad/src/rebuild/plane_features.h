// Which facets are offsets of planes: exact as they are.
#pragma once

#include <optional>
#include <vector>

#include "phront/cad/tessellate.h"
#include "phront/facet.h"

namespace phront::cad {

/// Per face its plane, see FacetOptions.
[[nodiscard]] std::vector<std::optional<Plane>> planesOf(const FeatureTable& features);

/// How many polygons stand in for something curved.
[[nodiscard]] int curvedFacets(const FacetedSurface& facets,
                               const std::vector<std::optional<Plane>>& planeOfFace);

}  // namespace phront::cad
