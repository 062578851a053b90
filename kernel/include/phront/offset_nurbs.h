// Offset of NURBS curves and surfaces by moving their control points.
#pragma once

#include <functional>

#include "phront/nurbs.h"
#include "phront/progress.h"

namespace phront {

/// Which knots an offset may have. Parameters are kept by both: S_d(u,v) stems from S(u,v).
enum class KnotRule {
  Original,  ///< degree and knots of the original; more knots only where the error asks for them
  Fewest,    ///< those, or another degree and other knots when that takes fewer poles
};

struct NurbsOffsetOptions {
  double distance = 0;   ///< along the normal, model units; either sign
  double tolerance = 0;  ///< > 0: most that the offset may be away from P + d n, model units
  KnotRule knots = KnotRule::Original;
  /// The tolerance also bounds |S_d - d n_d - S|, the way back along the offset's own normals n_d
  /// (where it is not about to fold), so that an offset by -d to the same tolerance ends within
  /// twice the tolerance of the original. Of curves n_d is what of n is normal to the offset. Takes
  /// more poles: about twice as many on smooth surfaces, far more where normals ripple.
  bool reversible = false;
  int maxPoles = 40'000;
};

/// How the poles of an offset were found.
enum class PoleRule {
  Moved,   ///< each by d along the normal at its parameter (Coquillart 1987)
  Fitted,  ///< least squares: the offset comes nearest to many moved points at their parameters
};

struct CurveOffset {
  NurbsCurve curve;
  /// Largest |C_d(t) - (C + d n)(t)| found, if reversible also |C_d - d n_d - C|: at most the
  /// tolerance.
  double error = 0;
  PoleRule rule = PoleRule::Fitted;
};

struct SurfaceOffset {
  NurbsSurface surface;
  /// Largest |S_d - (S + d n)| found, if reversible also |S_d - d n_d - S|: at most the tolerance.
  double error = 0;
  PoleRule rule = PoleRule::Fitted;
};

/// Unit normal at a parameter of a curve.
using CurveNormal = std::function<Vec3(double t)>;

/// Normal of a curve in a plane with the given unit normal: to the right of the curve when the
/// plane's normal points to the eye, so that d > 0 grows what a counter-clockwise curve bounds.
[[nodiscard]] CurveNormal normalInPlane(const NurbsCurve& curve, const Vec3& planeNormal);

/// Of the pole rules and of the knots allowed the fewest poles win; an offset that is exact with
/// the original's knots has them. Where |d| exceeds the radius of curvature the offset folds back,
/// as P + d n does. A corner below 1e-6 rad, or of which |d| makes a gap below a quarter of the
/// tolerance, is none. Fails with InvalidArgument (bad numbers; no normal; a corner: offset the
/// pieces), ResourceLimit (more than maxPoles).
[[nodiscard]] Result<CurveOffset> offsetNurbs(const NurbsCurve& curve, const CurveNormal& normal,
                                              const NurbsOffsetOptions& options);

/// The same for a surface, along S_u x S_v. At poles and degenerate edges the normal is the limit
/// from inside; where the surface folds back on itself it does not turn over with S_u x S_v, but
/// goes on as it is where the surface is stretched most. A surface that was fitted to a fold has
/// normals that swing through every direction in a narrow band there: where they ask for too many
/// poles, what is left of S_u x S_v on the fold is taken off beside it. Fails as for curves, and
/// with Cancelled.
[[nodiscard]] Result<SurfaceOffset> offsetNurbs(const NurbsSurface& surface,
                                                const NurbsOffsetOptions& options,
                                                const Progress& progress = {});

/// Where offsetNurbs would find a corner or an edge: at a knot (low = high), or in a strip narrower
/// than a quarter of the tolerance in which the normal turns by more than half a radian. Rising,
/// apart; strips may reach the ends of the domain. Offset what is between them.
[[nodiscard]] std::vector<Interval> cornerStrips(const NurbsCurve& curve, const CurveNormal& normal,
                                                 const NurbsOffsetOptions& options);
struct EdgeStrips {
  std::vector<Interval> u, v;
};
[[nodiscard]] EdgeStrips edgeStrips(const NurbsSurface& surface, const NurbsOffsetOptions& options);

/// Any curve as a spline with its parameter: `knots` say degree, domain and where it is less
/// smooth. distance and reversible are not used; fails as offsetNurbs does.
[[nodiscard]] Result<CurveOffset> fitCurve(const std::function<Vec3(double t)>& point,
                                           const Knots& knots, const NurbsOffsetOptions& options);

}  // namespace phront
