// Where no attempt on a whole sheet passes: the trimmed offsets of its faces, one by one.
#pragma once

#include "deadline.h"
#include "judge/check_body.h"
#include "phront/cad/offset_shape.h"
#include "tessellate/true_distance.h"

namespace phront::cad {

struct SheetAttempt {
  std::vector<Body> bodies;  ///< none when a face failed
  int exactFaces = 0;
  int fittedFaces = 0;
  CheckResult check;
};

/// Offsets each face of `healed`, which `phi` measures, cuts it back to the front, and sews what
/// then meets. Convex edges get no rounds. Fails with Cancelled.
[[nodiscard]] Result<SheetAttempt> sheetOfFaces(const Body& healed, const OffsetOptions& options,
                                                const TrueDistance& phi, const BodyCheck& check,
                                                const Deadline& deadline, const Progress& progress);

}  // namespace phront::cad
