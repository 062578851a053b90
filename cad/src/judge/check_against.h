// The check against an input whose distance is known already: many results, one input.
#pragma once

#include "judge/check_sampling.h"
#include "phront/cad/check.h"

namespace phront::cad {

/// checkOffset() without tessellating the input again; `in` is that input's distance.
[[nodiscard]] Result<CheckResult> checkAgainst(const ModelDistance& in, const Model& out,
                                               const CheckOptions& options);

}  // namespace phront::cad
