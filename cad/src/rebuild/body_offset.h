// The offset of one body: reference front, attempts at exact patches, facets as the last resort.
#pragma once

#include "phront/cad/offset_shape.h"

namespace phront::cad {

struct BodyOffset {
  std::vector<Body> bodies;  ///< result; empty when the offset is empty
  BodyReport report;
  std::vector<StageTime> times;
};

/// Fails only when the body cannot be worked on at all (no tessellation, cancelled); a body whose
/// every way failed comes back with OffsetKind::Failed and the reasons.
[[nodiscard]] Result<BodyOffset> offsetBody(const Body& body, const OffsetOptions& options,
                                            const Progress& progress);

}  // namespace phront::cad
