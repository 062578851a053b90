// NURBS curves and surfaces as plain data, and their evaluation.
#pragma once

#include <vector>

#include "phront/status.h"
#include "phront/types.h"

namespace phront {

/// Knots of a B-spline, each as often as its multiplicity, the first and the last degree + 1 times.
struct Knots {
  int degree = 1;            ///< 1 .. 25
  std::vector<double> flat;  ///< non-decreasing; inner multiplicity at most the degree

  [[nodiscard]] std::size_t poleCount() const {
    return flat.size() - static_cast<std::size_t>(degree) - 1;
  }
  [[nodiscard]] double first() const { return flat.front(); }
  [[nodiscard]] double last() const { return flat.back(); }
  /// Each knot once.
  [[nodiscard]] std::vector<double> distinct() const;
  /// Averages of `degree` successive knots: one parameter per pole, near its influence's middle
  /// (Greville 1964).
  [[nodiscard]] std::vector<double> greville() const;
};

/// Of a parameter.
struct Interval {
  double low = 0;
  double high = 0;
};

struct NurbsCurve {
  Knots knots;
  std::vector<Vec3> poles;
  std::vector<double> weights;  ///< one per pole, positive; empty: all 1
};

struct NurbsSurface {
  Knots u, v;
  std::vector<Vec3> poles;      ///< number i + j * u.poleCount()
  std::vector<double> weights;  ///< one per pole, positive; empty: all 1
};

/// Fails with InvalidArgument and says which number is wrong.
[[nodiscard]] Result<void> checkKnots(const Knots& knots);
[[nodiscard]] Result<void> checkNurbs(const NurbsCurve& curve);
[[nodiscard]] Result<void> checkNurbs(const NurbsSurface& surface);

/// Position and derivatives at a parameter, held to the domain. At a knot of multiplicity `degree`
/// those of the side towards larger parameters.
struct CurvePoint {
  Vec3 position, tangent;  ///< C, C'
  double weight = 1;       ///< denominator of C
};
[[nodiscard]] CurvePoint evaluate(const NurbsCurve& curve, double t);

struct SurfacePoint {
  Vec3 position, alongU, alongV;  ///< S, S_u, S_v
  double weight = 1;              ///< denominator of S
};
[[nodiscard]] SurfacePoint evaluate(const NurbsSurface& surface, double u, double v);

}  // namespace phront
