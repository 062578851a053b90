#include "rebuild/plane_features.h"

#include <algorithm>

namespace phront::cad {

std::vector<std::optional<Plane>> planesOf(const FeatureTable& features) {
  std::vector<std::optional<Plane>> planes;
  for (const FaceFeature& face : features.faces) planes.push_back(face.plane);
  return planes;
}

int curvedFacets(const FacetedSurface& facets,
                 const std::vector<std::optional<Plane>>& planeOfFace) {
  return static_cast<int>(
      std::count_if(facets.polygons.begin(), facets.polygons.end(), [&](const FacetPolygon& p) {
        return p.feature.kind != FeatureKind::Face ||
               !planeOfFace[static_cast<std::size_t>(p.feature.id)];
      }));
}

}  // namespace phront::cad
