// What the judges of walls (of shells, of thickened sheets) have in common: from figures to
// reasons.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "judge/check_sampling.h"
#include "judge/check_shell.h"
#include "judge/check_topology.h"
#include "phront/cad/check.h"
#include "phront/status.h"

namespace phront::cad {

/// What the check of a wall is to say of one point of the result.
struct WallPoint {
  double error = 0;  ///< mm, >= 0: distance from where a boundary belongs
  bool farSide =
      false;  ///< it belongs to the far side of a wall: the error is one of its thickness
};

struct WallFigures {
  WeightedErrors walls;    ///< of points on the far sides of walls: error of the thickness, mm
  WeightedErrors all;      ///< of all points: distance from where a boundary belongs, mm
  WeightedErrors missing;  ///< of points where there must be a boundary: distance to it, mm
  double max = 0;          ///< of `all`
  double missingMax = 0;
  double buried = 0;  ///< share of the area that lies inside
  Vec3 worst = Vec3::Zero();
  Vec3 worstMissing = Vec3::Zero();

  /// Samples of the result; `pointAt` judges each.
  void addSamples(const ModelDistance& out, int samples, SampleRng& rng,
                  const std::function<WallPoint(const Vec3&)>& pointAt);
  void addMissing(const Vec3& point, double error, double weight);
};

/// How finely the input `in` and its wall are tessellated.
[[nodiscard]] TessellateOptions wallMesh(const Body& in, const ShellCheckOptions& options);

/// Fills in topology and reasons why it is not that of a wall; empty where the distance to the wall
/// need not or cannot be measured.
[[nodiscard]] std::optional<ModelDistance> measurableWall(const std::vector<Body>& out,
                                                          const TessellateOptions& mesh,
                                                          CheckResult& result);

/// Fills in figures and reasons; `tolerance` mm, as in CheckOptions.
void judgeWalls(const WallFigures& figures, double tolerance, CheckResult& result);

/// Runs a check of a wall in a guarded child. Fails with what it fails with, Failed, ResourceLimit.
[[nodiscard]] Result<CheckResult> checkInChild(double seconds,
                                               const std::function<Result<CheckResult>()>& check);

}  // namespace phront::cad
