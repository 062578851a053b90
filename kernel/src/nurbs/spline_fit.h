// Least squares by B-splines, for many curves with the same knots at once.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "nurbs/basis.h"
#include "phront/nurbs.h"

namespace phront {

/// One row per parameter or per pole, the columns are the curves' coordinates.
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Basis functions at parameters.
class BasisRows {
 public:
  BasisRows(const Knots& knots, std::span<const double> parameters);
  [[nodiscard]] std::size_t size() const { return rows_.size(); }
  [[nodiscard]] std::size_t poleCount() const { return poleCount_; }
  [[nodiscard]] std::size_t order() const { return order_; }
  [[nodiscard]] const BasisAt& operator[](std::size_t i) const { return rows_[i]; }

  /// One row per pole in, one per parameter out.
  [[nodiscard]] Rows times(const Rows& poles) const;
  [[nodiscard]] Rows slopeTimes(const Rows& poles) const;

 private:
  template <class Row>
  [[nodiscard]] Rows combined(const Rows& poles, const Row& row) const;

  std::vector<BasisAt> rows_;
  std::size_t poleCount_ = 0;
  std::size_t order_ = 0;
};

/// Poles of the curves that pass through the first and the last of the values and come nearest to
/// the others in the sum of squares. The first and the last parameter are the ends of the domain.
/// Empty when some pole has no parameter to hold it.
[[nodiscard]] Rows fitPoles(const BasisRows& basis, const Rows& values);

/// `count` parameters strictly inside each span and all knots: rising.
[[nodiscard]] std::vector<double> densely(const Knots& knots, int count);

}  // namespace phront
