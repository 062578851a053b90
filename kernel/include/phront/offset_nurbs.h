// Offset of NURBS curves and surfaces by moving their control points.
#pragma once

#include <functional>

#include "phront/nurbs.h"
#include "phront/progress.h"

namespace phront {

struct NurbsOffsetOptions {
  double distance = 0;   ///< along the normal, model units; either sign
  double tolerance = 0;  ///< > 0: most that the offset may be away from P + d n, model units
  int maxPoles = 40'000;
};

/// How the poles of an offset were found.
enum class PoleRule {
  Moved,         ///< each by d along the normal at its parameter (Coquillart 1987)
  Interpolated,  ///< so that the offset passes through the moved points at those parameters
};

struct CurveOffset {
  NurbsCurve curve;  ///< same degree and parameter as the original: C_d(t) stems from C(t)
  double error = 0;  ///< largest |C_d(t) - (C + d n)(t)| found, at most the tolerance
  PoleRule rule = PoleRule::Interpolated;
};

struct SurfaceOffset {
  NurbsSurface surface;  ///< same degrees and parameters as the original
  double error = 0;      ///< largest |S_d(u,v) - (S + d n)(u,v)| found, at most the tolerance
  PoleRule rule = PoleRule::Interpolated;
};

/// Unit normal at a parameter of a curve.
using CurveNormal = std::function<Vec3(double t)>;

/// Normal of a curve in a plane with the given unit normal: to the right of the curve when the
/// plane's normal points to the eye, so that d > 0 grows what a counter-clockwise curve bounds.
[[nodiscard]] CurveNormal normalInPlane(const NurbsCurve& curve, const Vec3& planeNormal);

/// The offset keeps the original's knots where they do for the tolerance, else knots are added
/// where the measured error asks for them. Of the two pole rules the one with fewer poles wins.
/// Where |d| exceeds the radius of curvature the offset folds back, as P + d n does. Fails with
/// InvalidArgument (bad numbers; no normal; a corner: offset the pieces), ResourceLimit (more than
/// maxPoles, or 1000 along one direction).
[[nodiscard]] Result<CurveOffset> offsetNurbs(const NurbsCurve& curve, const CurveNormal& normal,
                                              const NurbsOffsetOptions& options);

/// The same for a surface, along S_u x S_v. At poles and degenerate edges the normal is the limit
/// from inside. Fails as for curves, and with Cancelled.
[[nodiscard]] Result<SurfaceOffset> offsetNurbs(const NurbsSurface& surface,
                                                const NurbsOffsetOptions& options,
                                                const Progress& progress = {});

}  // namespace phront
