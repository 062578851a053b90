// Whether a solid is the shell of a body: the judge of hollowing.
#pragma once

#include <optional>
#include <vector>

#include "phront/cad/check.h"
#include "phront/cad/shape.h"
#include "phront/status.h"

namespace phront::cad {

/// Wall on either side of the faces that are not open, mm, >= 0, not both 0.
struct ShellWalls {
  double inner = 0;
  double outer = 0;
  [[nodiscard]] double thickness() const { return inner + outer; }
};

/// What the far side of a wall is as far from as the wall is thick: the body, with those faces
/// moved that have a thickness of their own.
struct WallBase {
  Body body;
  std::vector<int> open;  ///< 0-based
};

/// Empty where no face has a thickness of its own.
struct WallBases {
  std::optional<WallBase> inner;
  std::optional<WallBase> outer;
  double thickest = 0;  ///< mm, largest thickness that a face has of its own
};

struct ShellCheckOptions {
  ShellWalls walls;
  WallBases bases = {};
  double tolerance = 0;  ///< mm, > 0, as in CheckOptions
  int samples = 20'000;
  double timeLimit = 60;  ///< s, for the guarded child that measures
};

/// `open`: 0-based faces of the solid `in`, planar. The shell is all within the wall's distance of
/// the closed faces (as the bases have them), on its side of them and not beyond an opening.
/// Accuracy: how far the walls of OUT are from that distance (p99), and how far any of its points
/// is from where a boundary of the shell belongs (max). Coverage: how much of the walls' true
/// surfaces is missing. Passes as checkOffset does. Independent of how OUT was made. Fails with
/// Failed, ResourceLimit.
[[nodiscard]] Result<CheckResult> checkBodyShell(const Body& in, const std::vector<int>& open,
                                                 const std::vector<Body>& out,
                                                 const ShellCheckOptions& options);

}  // namespace phront::cad
