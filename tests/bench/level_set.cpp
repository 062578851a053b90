#include "level_set.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace phront::bench {

std::vector<double> levelSetTimes(const SphereProblem& problem) {
  const std::int32_t n = problem.grid.nodes[0];
  const double h = problem.grid.spacing;
  const double dt = 0.5 * h;  // stable below h / sqrt(3)
  const double known = 3 * h;
  std::vector<double> psi;
  for (std::int32_t k = 0; k < n; ++k) {
    for (std::int32_t j = 0; j < n; ++j) {
      for (std::int32_t i = 0; i < n; ++i)
        psi.push_back(std::clamp(problem.signedExact(i, j, k), -known, known));
    }
  }
  std::vector<double> times(psi.size(), 0);
  std::vector<double> next = psi;
  const std::array<std::ptrdiff_t, 3> strides{1, n, static_cast<std::ptrdiff_t>(n) * n};
  const int steps = static_cast<int>(std::ceil(1.0 / dt));  // farther than any corner
  for (int step = 0; step < steps; ++step) {
    std::size_t at = 0;
    for (std::int32_t k = 0; k < n; ++k) {
      for (std::int32_t j = 0; j < n; ++j) {
        for (std::int32_t i = 0; i < n; ++i, ++at) {
          const std::array<std::int32_t, 3> place{i, j, k};
          double squares = 0;
          for (std::size_t axis = 0; axis < 3; ++axis) {
            const double* here = psi.data() + at;
            const double back = place[axis] > 0 ? *here - here[-strides[axis]] : 0;
            const double ahead = place[axis] < n - 1 ? here[strides[axis]] - *here : 0;
            const double rise = std::max({back, -ahead, 0.0}) / h;
            squares += rise * rise;
          }
          next[at] = psi[at] - dt * std::sqrt(squares);
          if (psi[at] > 0 && next[at] <= 0)
            times[at] = dt * (step + psi[at] / (psi[at] - next[at]));
        }
      }
    }
    std::swap(psi, next);
  }
  return times;
}

}  // namespace phront::bench
