// The iso-surface itself becomes the solid: the last resort, closed whatever the part is like.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "deadline.h"
#include "judge/check_body.h"
#include "phront/cad/offset_shape.h"
#include "phront/iso_surface.h"
#include "tessellate/true_distance.h"

namespace phront::cad {

struct FacetAttempt {
  std::vector<Body> bodies;  ///< empty: no solid could be made, `check` says why
  int planarFaces = 0;       ///< offsets of planar faces, one polygon each
  int facets = 0;            ///< planar facets that stand in for curved offset surfaces
  CheckResult check;         ///< against the body as read
};

/// Facets of the front, checked; when they do not pass and the front hides thin features, of a
/// finer one; when there is no solid at all, coarse facets far off the tolerance, which then fail
/// their check but are valid and closed. The best of them comes back. Without a front (null) only
/// the coarse ones are made. Guarded; bounded by the deadline.
[[nodiscard]] FacetAttempt facetBody(const Body& body, const OffsetOptions& options,
                                     const TrueDistance& phi, const BodyCheck& check,
                                     const IsoSurface* front, const Deadline& deadline);

}  // namespace phront::cad
