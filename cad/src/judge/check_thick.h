// Whether a solid is a thickened sheet: the judge of `shell` on sheets.
#pragma once

#include <vector>

#include "judge/check_shell.h"

namespace phront::cad {

/// As checkBodyShell, for the sheet `in`: `out` is all p + h n with p on the sheet and n its
/// normal, h from -walls.inner to walls.outer, and stands straight on the free edges. Accuracy: how
/// far the two sides are from their height, and any point from where a boundary belongs. Coverage:
/// what of the sides and of the walls on the free edges is missing. Independent of how OUT was
/// made.
[[nodiscard]] Result<CheckResult> checkThickSheet(const Body& in, const std::vector<Body>& out,
                                                  const ShellCheckOptions& options);

}  // namespace phront::cad
