// The wall of one solid: extended through its openings, offset, and what lies between.
#pragma once

#include <vector>

#include "judge/check_shell.h"
#include "phront/cad/shell_shape.h"

namespace phront::cad {

struct ShellBodyRequest {
  /// 0-based faces of the body; where one is not planar the inner base goes on beyond it.
  std::vector<int> open;
  int firstNumber = 1;  ///< of the body's first face, as the user counts them
  ShellWalls walls;
  WallBases bases = {};
  double tolerance = 0;  ///< mm
  int threads = 0;
  double timeLimit = 0;  ///< s
};

struct BodyShell {
  std::vector<Body> bodies;
  BodyReport report;
  std::vector<StageTime> times;
  bool full = false;  ///< too thin to be hollow: the body itself
};

/// Fails only when the body cannot be worked on at all; else what went wrong is in the report.
[[nodiscard]] Result<BodyShell> shellBody(const Body& body, const ShellBodyRequest& request,
                                          const Progress& progress);

}  // namespace phront::cad
