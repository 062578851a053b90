// Offset of planar curves: the front phi = d as polygons.
#pragma once

#include <optional>

#include "phront/curve_distance.h"
#include "phront/curve_mesh.h"
#include "phront/progress.h"
#include "phront/status.h"

namespace phront {

struct OffsetCurveOptions {
  double distance = 0;  ///< d, signed, finite, not zero: to the right, out of material
  /// Largest distance of the polygons' sides from phi = d, model units; automatic: 1e-3 |d|.
  std::optional<double> tolerance = std::nullopt;
  int threads = 0;                     ///< 0: all cores
  std::int64_t maxNodes = 50'000'000;  ///< of the grid; refuse beyond (ResourceLimit)
};

struct OffsetCurve {
  CurveMesh curves;      ///< material (phi < d) to the left; empty when no point has phi = d
  double spacing = 0;    ///< of the grid that found them, model units
  double deviation = 0;  ///< measured: largest |phi - d| of corners, thirds and middles of sides
};

/// All points with phi = d: closed polygons for closed curves (arc joins: true distance), lines
/// that end beyond the ends of open ones. Corners lie on phi = d to round-off, also where fronts of
/// different segments meet; sides are as long as the tolerance allows. Parts of the front that fit
/// between neighbouring nodes of the grid are missed: narrower than `spacing`; `deviation` tells.
/// Fails with InvalidArgument, ResourceLimit, Cancelled.
[[nodiscard]] Result<OffsetCurve> offsetCurve(const CurveDistance& curves,
                                              const OffsetCurveOptions& options,
                                              const Progress& progress = {});

}  // namespace phront
