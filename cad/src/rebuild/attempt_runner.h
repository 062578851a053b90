// Runs attempts at exact patches in guarded children and lets the judge choose.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "deadline.h"
#include "phront/cad/offset_shape.h"
#include "rebuild/exact_offset.h"
#include "rebuild/true_distance.h"

namespace phront::cad {

/// What the front phi = d says the result must be.
struct FrontReference {
  double volume = 0;   ///< mm^3 enclosed by the iso-surface
  double area = 0;     ///< mm^2
  double spacing = 0;  ///< mm, its grid
};

/// Samples of a check before a result is offered: kCheckStrictness leaves room for their noise. The
/// user's own check takes more.
inline constexpr int kOfferedSamples = 6000;

struct AcceptedAttempt {
  std::vector<Body> bodies;
  std::string setting;
  int fittedFaces = 0;
  CheckResult check;
};

struct AttemptLog {
  std::optional<AcceptedAttempt> accepted;
  std::vector<std::string> lines;  ///< one per attempt: setting, outcome, seconds
};

/// Tries the settings in order (two at a time when threads allow) until one result passes the check
/// and agrees with the reference (sheets have none), or the `deadline` is reached. With two at a
/// time the earlier setting wins, so the choice does not depend on who finishes first. `healed` is
/// offset and `phi` is its distance; results are checked against `body`, as read.
[[nodiscard]] AttemptLog runAttempts(const Body& body, const Body& healed,
                                     const OffsetOptions& options, const TrueDistance& phi,
                                     const std::optional<FrontReference>& reference,
                                     const Deadline& deadline, const Progress& progress);

/// Splits a shape into bodies: one per solid, one per connected sheet.
[[nodiscard]] std::vector<Body> bodiesOf(const TopoDS_Shape& shape, BodyKind kind,
                                         const std::string& name);

}  // namespace phront::cad
