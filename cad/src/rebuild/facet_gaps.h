// Holes and faults in a set of pieces: the pieces at fault go, facets take their place.
#pragma once

#include <TopoDS_Face.hxx>
#include <optional>
#include <vector>

#include "phront/facet.h"
#include "phront/iso_surface.h"
#include "phront/status.h"
#include "tessellate/true_distance.h"

namespace phront::cad {

struct FacetGapOptions {
  double distance = 0;   ///< mm, signed: the level
  double tolerance = 0;  ///< mm, > 0: how far facets may be off the level
  /// Per face of the part its plane, see FacetOptions.
  std::vector<std::optional<Plane>> planeOfFace = {};
};

struct FacetedGaps {
  std::vector<TopoDS_Face> faces;  ///< the pieces that stay, edges around holes divided; facets
  int facets = 0;                  ///< the last so many of them
  int curvedFacets = 0;            ///< of these, those that are no offsets of planes
};

/// Takes away pieces that leave the level, that use an edge too often, or at which the edges of
/// holes do not close, then fills every hole with facets of `front` (phi = d, or nearly) that share
/// the edges of the pieces around it, which become lines there. Fails when there is no hole, when
/// too much would go, or when a hole cannot be filled. May throw, hang or crash with OpenCASCADE.
[[nodiscard]] Result<FacetedGaps> facetGaps(std::vector<TopoDS_Face> pieces,
                                            const FacetGapOptions& options, const IsoSurface& front,
                                            const TrueDistance& phi);

}  // namespace phront::cad
