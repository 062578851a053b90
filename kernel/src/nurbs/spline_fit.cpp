#include "nurbs/spline_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace phront {
namespace {

constexpr double kSingular = 1e-13;  // pivot over the diagonal it came from

Eigen::Index at(std::size_t i) { return static_cast<Eigen::Index>(i); }

/// Symmetric positive definite matrix with few diagonals: L D L^T. Eigen has none for bands.
class BandedSystem {
 public:
  BandedSystem(std::size_t size, std::size_t below)
      : size_(size), below_(below), band_(size * (below + 1), 0) {}

  /// Entry (i, i - k), 0 <= k <= below.
  double& operator()(std::size_t i, std::size_t k) { return band_[i * (below_ + 1) + k]; }

  /// The solution takes the place of the right sides; false when the matrix is singular.
  [[nodiscard]] bool solve(Rows& right) {
    if (!factor()) return false;
    for (std::size_t i = 0; i < size_; ++i) {
      for (std::size_t k = 1; k <= std::min(i, below_); ++k)
        right.row(at(i)) -= (*this)(i, k) * right.row(at(i - k));
    }
    for (std::size_t i = size_; i-- > 0;) {
      right.row(at(i)) /= (*this)(i, 0);
      for (std::size_t k = 1; k <= std::min(size_ - 1 - i, below_); ++k)
        right.row(at(i)) -= (*this)(i + k, k) * right.row(at(i + k));
    }
    return true;
  }

 private:
  bool factor() {
    for (std::size_t i = 0; i < size_; ++i) {
      const double diagonal = (*this)(i, 0);
      for (std::size_t k = std::min(i, below_); k >= 1; --k) {
        const std::size_t j = i - k;
        for (std::size_t m = k + 1; m <= std::min(i, below_); ++m)
          (*this)(i, k) -= (*this)(i, m) * (*this)(j, m - k) * (*this)(i - m, 0);
        (*this)(i, k) /= (*this)(j, 0);
      }
      for (std::size_t k = 1; k <= std::min(i, below_); ++k)
        (*this)(i, 0) -= (*this)(i, k) * (*this)(i, k) * (*this)(i - k, 0);
      if (!((*this)(i, 0) > kSingular * diagonal)) return false;
    }
    return true;
  }

  std::size_t size_, below_;
  std::vector<double> band_;
};

}  // namespace

BasisRows::BasisRows(const Knots& knots, std::span<const double> parameters)
    : poleCount_(knots.poleCount()), order_(static_cast<std::size_t>(knots.degree) + 1) {
  rows_.reserve(parameters.size());
  for (const double t : parameters) rows_.push_back(basisAt(knots, t));
}

template <class Row>
Rows BasisRows::combined(const Rows& poles, const Row& row) const {
  Rows result = Rows::Zero(at(rows_.size()), poles.cols());
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    for (std::size_t k = 0; k < order_; ++k)
      result.row(at(i)) += row(rows_[i])[k] * poles.row(at(rows_[i].first + k));
  }
  return result;
}

Rows BasisRows::times(const Rows& poles) const {
  return combined(
      poles, [](const BasisAt& b) -> const auto& { return b.value; });
}

Rows BasisRows::slopeTimes(const Rows& poles) const {
  return combined(
      poles, [](const BasisAt& b) -> const auto& { return b.slope; });
}

Rows fitPoles(const BasisRows& basis, const Rows& values) {
  const std::size_t count = basis.poleCount();
  Rows poles(at(count), values.cols());
  poles.row(0) = values.row(0);
  poles.row(at(count - 1)) = values.row(values.rows() - 1);
  if (count == 2) return poles;
  const std::size_t inner = count - 2;
  const auto isEnd = [&](std::size_t pole) { return pole == 0 || pole == count - 1; };
  BandedSystem system(inner, std::min(basis.order() - 1, inner - 1));
  Rows right = Rows::Zero(at(inner), values.cols());
  Eigen::RowVectorXd rest(values.cols());
  for (std::size_t i = 0; i < basis.size(); ++i) {
    const BasisAt& row = basis[i];
    rest = values.row(at(i));
    for (std::size_t a = 0; a < basis.order(); ++a) {
      if (isEnd(row.first + a)) rest -= row.value[a] * poles.row(at(row.first + a));
    }
    for (std::size_t a = 0; a < basis.order(); ++a) {
      if (isEnd(row.first + a)) continue;
      const std::size_t pole = row.first + a - 1;
      right.row(at(pole)) += row.value[a] * rest;
      for (std::size_t b = 0; b <= a; ++b) {
        if (!isEnd(row.first + b)) system(pole, a - b) += row.value[a] * row.value[b];
      }
    }
  }
  if (!system.solve(right)) return {};
  poles.middleRows(1, at(inner)) = right;
  return poles;
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

}  // namespace phront
