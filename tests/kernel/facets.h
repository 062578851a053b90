// Measures of faceted surfaces.
#pragma once

#include "phront/facet.h"

namespace phront::test {

/// Along the normal, as long as the area.
inline Vec3 areaVectorOf(const FacetedSurface& facets, const FacetPolygon& polygon) {
  Vec3 twice = Vec3::Zero();
  for (const auto& loop : polygon.loops)
    for (std::size_t k = 1; k + 1 < loop.size(); ++k)
      twice += (facets.points[loop[k]] - facets.points[loop[0]])
                   .cross(facets.points[loop[k + 1]] - facets.points[loop[0]]);
  return twice / 2;
}

inline double areaOf(const FacetedSurface& facets) {
  double sum = 0;
  for (const FacetPolygon& polygon : facets.polygons) sum += areaVectorOf(facets, polygon).norm();
  return sum;
}

}  // namespace phront::test
