// Fast sweeping as papers print it: three nested loops and a branch for each case (Zhao 2005).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "problems.h"

namespace phront::bench {

template <class Real>
class NaiveSweep {
 public:
  explicit NaiveSweep(const SphereProblem& problem)
      : n_(problem.grid.nodes[0]), h_(static_cast<Real>(problem.grid.spacing)) {
    for (const double value : problem.known) {
      fixed_.push_back(std::isfinite(value) ? 1 : 0);
      u_.push_back(std::isfinite(value) ? static_cast<Real>(value) : kNone);
    }
  }

  void sweep(unsigned ordering) {
    const std::ptrdiff_t n = n_;
    for (std::ptrdiff_t c = 0; c < n; ++c) {
      const std::ptrdiff_t k = (ordering & 4U) != 0 ? n - 1 - c : c;
      for (std::ptrdiff_t b = 0; b < n; ++b) {
        const std::ptrdiff_t j = (ordering & 2U) != 0 ? n - 1 - b : b;
        for (std::ptrdiff_t a = 0; a < n; ++a) {
          const std::ptrdiff_t i = (ordering & 1U) != 0 ? n - 1 - a : a;
          update(i, j, k);
        }
      }
    }
  }

  [[nodiscard]] std::vector<double> times() const { return {u_.begin(), u_.end()}; }

 private:
  static constexpr Real kNone = Real(1e30);

  void update(std::ptrdiff_t i, std::ptrdiff_t j, std::ptrdiff_t k) {
    const std::ptrdiff_t n = n_;
    const auto at = static_cast<std::size_t>((k * n + j) * n + i);
    if (fixed_[at] != 0) return;
    const auto smaller = [&](std::ptrdiff_t place, std::ptrdiff_t stride) {
      const Real* u = u_.data() + at;
      return std::min(place > 0 ? u[-stride] : kNone, place < n - 1 ? u[stride] : kNone);
    };
    Real x = smaller(i, 1);
    Real y = smaller(j, n);
    Real z = smaller(k, n * n);
    if (x > y) std::swap(x, y);
    if (y > z) std::swap(y, z);
    if (x > y) std::swap(x, y);
    Real u = x + h_;
    if (u > y) {
      u = (x + y + std::sqrt(2 * h_ * h_ - (x - y) * (x - y))) / 2;
      if (u > z) {
        const Real sum = x + y + z;
        u = (sum + std::sqrt(sum * sum - 3 * (x * x + y * y + z * z - h_ * h_))) / 3;
      }
    }
    u_[at] = std::min(u_[at], u);
  }

  std::ptrdiff_t n_;
  Real h_;
  std::vector<Real> u_;
  std::vector<char> fixed_;
};

}  // namespace phront::bench
