// The iso-surface itself becomes the solid: the last resort, closed whatever the part is like.
#pragma once

#include <string>
#include <vector>

#include "deadline.h"
#include "judge/check_body.h"
#include "phront/cad/offset_shape.h"
#include "phront/progress.h"
#include "phront/status.h"
#include "tessellate/true_distance.h"

namespace phront::cad {

struct FacetAttempt {
  std::vector<Body> bodies;  ///< empty: no solid could be made, the check says why
  int planarFaces = 0;       ///< offsets of planar faces, one polygon each
  int facets = 0;            ///< planar facets that stand in for curved offset surfaces
  FileCheck file;            ///< against the body as read
};

/// Facets of the front, checked; where there is no solid at all, coarse ones. `phi` is the distance
/// of the part, finely tessellated: facets have nothing truer; `name` is its name. Guarded; bounded
/// by the deadline. Fails with Cancelled only.
[[nodiscard]] Result<FacetAttempt> facetBody(const std::string& name, const OffsetOptions& options,
                                             const TrueDistance& phi, const BodyCheck& check,
                                             const Deadline& deadline, const Progress& progress);

/// Some seconds whatever the part: facets far off the tolerance, which fail their check but are
/// valid and closed.
[[nodiscard]] FacetAttempt coarseFacets(const std::string& name, const OffsetOptions& options,
                                        const TrueDistance& phi, const BodyCheck& check,
                                        const Deadline& deadline);

}  // namespace phront::cad
