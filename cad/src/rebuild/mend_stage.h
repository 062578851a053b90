// Exact pieces that do not close, mended with facets where they fail.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "deadline.h"
#include "judge/check_body.h"
#include "phront/cad/offset_shape.h"
#include "phront/progress.h"
#include "rebuild/attempt_runner.h"
#include "tessellate/true_distance.h"

namespace phront::cad {

/// Takes the sets of pieces in order until one, with facets of the front in place of what is wrong
/// with it or missing, passes the check: that one, or the first that does not pass. Each leaves a
/// line in `log`. Guarded; bounded by the deadline. `phi` is the distance of the part that `check`
/// measures against, `name` its name.
[[nodiscard]] std::optional<JudgedAttempt> mendPieces(
    const std::vector<OpenPieces>& open, const std::string& name, const OffsetOptions& options,
    const TrueDistance& phi, const BodyCheck& check, const Deadline& deadline,
    const Progress& progress, std::vector<std::string>& log);

}  // namespace phront::cad
