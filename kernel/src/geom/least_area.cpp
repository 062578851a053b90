#include "phront/least_area.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace phront {
namespace {

constexpr double kFlat = 1e-9;    // area to the squares of the sides: below, corners lie in line
constexpr double kPenalty = 1e3;  // for that, times the polygon's extent squared

using Triangle = std::array<Index, 3>;
using Polygon = std::vector<Index>;

Vec3 areaNormal(const Vec3& a, const Vec3& b, const Vec3& c) { return 0.5 * (b - a).cross(c - a); }

/// Area to the squares of the sides.
double fullness(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double sides = (a - b).squaredNorm() + (b - c).squaredNorm() + (c - a).squaredNorm();
  return sides > 0 ? areaNormal(a, b, c).norm() / sides : 0;
}

}  // namespace

Polygon joinLoops(const std::vector<Polygon>& loops, const std::vector<Vec3>& points) {
  Polygon polygon = loops.front();
  std::vector<std::size_t> left(loops.size() - 1);
  std::iota(left.begin(), left.end(), 1);
  while (!left.empty()) {
    double nearest = std::numeric_limits<double>::infinity();
    std::size_t chosen = 0;
    std::size_t from = 0;
    std::size_t to = 0;
    for (std::size_t k = 0; k < left.size(); ++k) {
      const Polygon& loop = loops[left[k]];
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        for (std::size_t j = 0; j < loop.size(); ++j) {
          const double d = (points[static_cast<std::size_t>(polygon[i])] -
                            points[static_cast<std::size_t>(loop[j])])
                               .squaredNorm();
          if (d > 0 && d < nearest) {
            nearest = d;
            chosen = k;
            from = i;
            to = j;
          }
        }
      }
    }
    const Polygon& loop = loops[left[chosen]];
    Polygon both(polygon.begin(), polygon.begin() + static_cast<std::ptrdiff_t>(from) + 1);
    for (std::size_t j = 0; j <= loop.size(); ++j) both.push_back(loop[(to + j) % loop.size()]);
    both.insert(both.end(), polygon.begin() + static_cast<std::ptrdiff_t>(from), polygon.end());
    polygon = std::move(both);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(chosen));
  }
  return polygon;
}

std::vector<Triangle> leastAreaTriangles(const Polygon& polygon, const std::vector<Vec3>& points,
                                         Flat flat, const TakenSides& taken) {
  const std::size_t n = polygon.size();
  const auto at = [&](std::size_t i) { return points[static_cast<std::size_t>(polygon[i])]; };
  Box3 box;
  for (std::size_t i = 0; i < n; ++i) box.extend(at(i));
  const double penalty = kPenalty * box.diagonal().squaredNorm();
  const auto cost = [&](std::size_t i, std::size_t j, std::size_t k) {
    if (polygon[i] == polygon[j] || polygon[j] == polygon[k] || polygon[i] == polygon[k])
      return std::numeric_limits<double>::infinity();
    const double area = areaNormal(at(i), at(j), at(k)).norm();
    const bool inLine = flat == Flat::Avoided && !(fullness(at(i), at(j), at(k)) > kFlat);
    return inLine ? penalty : area;
  };
  std::vector<double> best(n * n, 0);
  std::vector<std::size_t> middle(n * n, 0);
  for (std::size_t span = 2; span < n; ++span) {
    for (std::size_t i = 0; i + span < n; ++i) {
      const std::size_t k = i + span;
      double least = std::numeric_limits<double>::infinity();
      middle[i * n + k] = i + 1;
      const bool inside = span + 1 < n;
      if (inside && taken.contains(std::minmax(polygon[i], polygon[k]))) {
        best[i * n + k] = least;
        continue;
      }
      for (std::size_t j = i + 1; j < k; ++j) {
        const double rest = best[i * n + j] + best[j * n + k];
        if (rest >= least) continue;
        const double sum = rest + cost(i, j, k);
        if (sum < least) {
          least = sum;
          middle[i * n + k] = j;
        }
      }
      best[i * n + k] = least;
    }
  }
  if (n < 3 || !std::isfinite(best[n - 1])) return {};
  std::vector<Triangle> triangles;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, n - 1}};
  while (!open.empty()) {
    const auto [i, k] = open.back();
    open.pop_back();
    if (k < i + 2) continue;
    const std::size_t j = middle[i * n + k];
    triangles.push_back({polygon[i], polygon[j], polygon[k]});
    open.emplace_back(i, j);
    open.emplace_back(j, k);
  }
  return triangles;
}

}  // namespace phront
