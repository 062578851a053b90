// The check of one body's offset before it is offered.
#pragma once

#include <string>
#include <vector>

#include "phront/cad/check.h"
#include "phront/cad/offset_shape.h"

namespace phront::cad {

/// Samples of a check before a result is offered: kCheckStrictness leaves room for their noise. The
/// user's own check takes more.
inline constexpr int kOfferedSamples = 6000;

/// checkOffset of `result` against one body, within `seconds`; a check that fails to come about is
/// a check that does not pass. An empty result asks "is the true offset empty?".
[[nodiscard]] CheckResult checkBody(const Body& body, const std::vector<Body>& result,
                                    const OffsetOptions& options, double seconds);

/// A check that does not pass for this reason.
[[nodiscard]] CheckResult failedCheck(std::string reason);

}  // namespace phront::cad
