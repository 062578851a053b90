// Interpolation by B-splines.
#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "phront/nurbs.h"

namespace phront {

/// Basis functions at parameters: one row for each, one column per pole.
[[nodiscard]] Eigen::MatrixXd basisMatrix(const Knots& knots, std::span<const double> parameters);

/// `count` parameters strictly inside each span and all knots: rising.
[[nodiscard]] std::vector<double> densely(const Knots& knots, int count);

/// Interpolates at the Greville points.
class SplineInterpolation {
 public:
  explicit SplineInterpolation(const Knots& knots);
  [[nodiscard]] const std::vector<double>& parameters() const { return parameters_; }
  /// One row per parameter in, one row per pole out.
  [[nodiscard]] Eigen::MatrixXd poles(const Eigen::MatrixXd& values) const;

 private:
  std::vector<double> parameters_;
  Eigen::PartialPivLU<Eigen::MatrixXd> solver_;
};

/// The knots with `added` ones put in.
[[nodiscard]] Knots withKnots(const Knots& knots, std::span<const double> added);

}  // namespace phront
