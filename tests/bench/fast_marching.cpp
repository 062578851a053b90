#include "fast_marching.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <utility>

namespace phront::bench {

std::vector<double> fastMarching(const SphereProblem& problem) {
  const std::ptrdiff_t n = problem.grid.nodes[0];
  const double h = problem.grid.spacing;
  const std::array<std::ptrdiff_t, 3> strides{1, n, n * n};
  std::vector<double> u = problem.known;
  std::vector<char> done(u.size(), 0);
  using Entry = std::pair<double, std::ptrdiff_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> heap;
  for (std::size_t at = 0; at < u.size(); ++at) {
    if (std::isfinite(u[at])) heap.emplace(u[at], static_cast<std::ptrdiff_t>(at));
  }
  const auto forNeighbours = [&](std::ptrdiff_t at, std::size_t axis, const auto& visit) {
    const std::ptrdiff_t place = at / strides[axis] % n;
    if (place > 0) visit(at - strides[axis]);
    if (place < n - 1) visit(at + strides[axis]);
  };
  const auto update = [&](std::ptrdiff_t at) {
    std::array<double, 3> a;
    a.fill(std::numeric_limits<double>::infinity());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      forNeighbours(at, axis, [&](std::ptrdiff_t next) {
        const auto i = static_cast<std::size_t>(next);
        if (done[i] != 0) a[axis] = std::min(a[axis], u[i]);
      });
    }
    std::sort(a.begin(), a.end());
    double value = a[0] + h;
    double sum = a[0];
    double squares = a[0] * a[0];
    for (std::size_t used = 1; used < 3 && value > a[used]; ++used) {
      sum += a[used];
      squares += a[used] * a[used];
      const auto count = static_cast<double>(used + 1);
      value = (sum + std::sqrt(sum * sum - count * (squares - h * h))) / count;
    }
    double& here = u[static_cast<std::size_t>(at)];
    if (value < here) {
      here = value;
      heap.emplace(value, at);
    }
  };
  while (!heap.empty()) {
    const auto [value, at] = heap.top();
    heap.pop();
    char& isDone = done[static_cast<std::size_t>(at)];
    if (isDone != 0) continue;
    isDone = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      forNeighbours(at, axis, [&](std::ptrdiff_t next) {
        const auto i = static_cast<std::size_t>(next);
        if (done[i] == 0 && !std::isfinite(problem.known[i])) update(next);
      });
    }
  }
  return u;
}

}  // namespace phront::bench
