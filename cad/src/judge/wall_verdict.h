// What the judges of walls (of shells, of thickened sheets) have in common: from figures to
// reasons.
#pragma once

#include <functional>

#include "judge/check_sampling.h"
#include "judge/check_topology.h"
#include "phront/cad/check.h"
#include "phront/status.h"

namespace phront::cad {

struct WallFigures {
  WeightedErrors walls;    ///< of points on the far sides of walls: error of the thickness, mm
  WeightedErrors all;      ///< of all points: distance from where a boundary belongs, mm
  WeightedErrors missing;  ///< of points where there must be a boundary: distance to it, mm
  double max = 0;          ///< of `all`
  double missingMax = 0;
  double buried = 0;  ///< share of the area that lies inside
  Vec3 worst = Vec3::Zero();
  Vec3 worstMissing = Vec3::Zero();

  void addPoint(const Vec3& point, double error, bool wall, double weight);
  void addMissing(const Vec3& point, double error, double weight);
};

/// Fills in topology and reasons why it is not that of a wall.
void judgeTopology(const TopologyFigures& topology, CheckResult& result);

/// The same for the figures; `tolerance` mm, as in CheckOptions.
void judgeWalls(const WallFigures& figures, double tolerance, CheckResult& result);

/// Runs a check of a wall in a guarded child. Fails with what it fails with, Failed, ResourceLimit.
[[nodiscard]] Result<CheckResult> checkInChild(double seconds,
                                               const std::function<Result<CheckResult>()>& check);

}  // namespace phront::cad
