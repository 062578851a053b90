#include "front/spline_fit.h"

#include <algorithm>

#include "geom/spline_basis.h"

namespace phront {

Eigen::MatrixXd basisMatrix(const Knots& knots, std::span<const double> parameters) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(parameters.size()),
                                                 static_cast<Eigen::Index>(knots.poleCount()));
  for (std::size_t row = 0; row < parameters.size(); ++row) {
    const BasisAt basis = basisAt(knots, parameters[row]);
    for (std::size_t k = 0; k <= static_cast<std::size_t>(knots.degree); ++k) {
      matrix(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(basis.first + k)) =
          basis.value[k];
    }
  }
  return matrix;
}

std::vector<double> densely(const Knots& knots, int count) {
  const std::vector<double> ends = knots.distinct();
  std::vector<double> result;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    for (int i = 0; i <= count; ++i)
      result.push_back(ends[k] + (ends[k + 1] - ends[k]) * i / (count + 1));
  }
  result.push_back(ends.back());
  return result;
}

SplineInterpolation::SplineInterpolation(const Knots& knots)
    : parameters_(knots.greville()), solver_(basisMatrix(knots, parameters_)) {}

Eigen::MatrixXd SplineInterpolation::poles(const Eigen::MatrixXd& values) const {
  return solver_.solve(values);
}

Knots withKnots(const Knots& knots, std::span<const double> added) {
  Knots result = knots;
  result.flat.insert(result.flat.end(), added.begin(), added.end());
  std::sort(result.flat.begin(), result.flat.end());
  return result;
}

}  // namespace phront
