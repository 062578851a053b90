// The iso-surface itself becomes the result: the last resort. For a solid it is closed whatever the
// part is like, for a sheet it ends where the sheet does.
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
  std::vector<Body> bodies;  ///< empty: nothing is left, or could be made: the check says
  int planarFaces = 0;       ///< offsets of planar faces, one polygon each
  int facets = 0;            ///< planar facets that stand in for curved offset surfaces
  FileCheck file;            ///< against the body as read
};

/// Facets of the front, checked; where there are none at all, coarse ones. `phi` is the distance of
/// `body`, finely tessellated: facets have nothing truer. Guarded; bounded by the deadline. Fails
/// with Cancelled only.
[[nodiscard]] Result<FacetAttempt> facetBody(const Body& body, const OffsetOptions& options,
                                             const TrueDistance& phi, const BodyCheck& check,
                                             const Deadline& deadline, const Progress& progress);

/// Some seconds whatever the part: facets far off the tolerance, which fail their check but are
/// valid and, for a solid, closed.
[[nodiscard]] FacetAttempt coarseFacets(const Body& body, const OffsetOptions& options,
                                        const TrueDistance& phi, const BodyCheck& check,
                                        const Deadline& deadline);

}  // namespace phront::cad
