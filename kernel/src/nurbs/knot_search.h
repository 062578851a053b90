// Knots that let splines match given curves within a tolerance.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "nurbs/spline_fit.h"
#include "phront/nurbs.h"

namespace phront {

/// Curves over one parameter that are to share their knots.
struct CurveBundle {
  /// Points at rising parameters: one row for each, `stride` numbers for each curve.
  std::function<Rows(std::span<const double>)> at;
  int stride = 3;  ///< 3: (x, y, z); 4: with a weight, (w x, w y, w z, w)
};

/// Largest distance between the points of two rows; infinite when it is no number.
[[nodiscard]] double apart(const Eigen::Ref<const Eigen::RowVectorXd>& a,
                           const Eigen::Ref<const Eigen::RowVectorXd>& b, int stride);

using PolesOf = std::function<Rows(const Knots&)>;
/// Least squares.
[[nodiscard]] Rows fittedPoles(const CurveBundle& curves, const Knots& knots);

struct KnotLimits {
  double tolerance = 0;
  std::size_t maxPoles = 0;
  double narrowest = 1e-8;  ///< span, of the domain: where cutting does not help
};

/// `knots`, and more where `polesOf` them miss the curves by more than the tolerance; the error is
/// taken to fall with `order` when spans are cut. None: too many.
[[nodiscard]] std::optional<Knots> refinedKnots(const CurveBundle& curves, Knots knots,
                                                const PolesOf& polesOf, int order,
                                                const KnotLimits& limits);

/// As few knots as can be found for splines of a degree fitted to curves that are one time less
/// smooth at the knots of `original` than splines over it. None: too many.
[[nodiscard]] std::optional<Knots> fewestKnots(const CurveBundle& curves, const Knots& original,
                                               int degree, const KnotLimits& limits);

}  // namespace phront
