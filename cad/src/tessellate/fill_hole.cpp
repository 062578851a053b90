// Minimal-area triangulation of a loop by dynamic programming over sub-chains (Barequet & Sharir
// 1995), O(n^3); longer loops lose their smallest ear until they are short enough.
#include "tessellate/fill_hole.h"

#include <limits>
#include <numeric>

namespace phront::cad {
namespace {

constexpr std::size_t kExactLimit = 160;  // points; n^3 / 6 areas stay in the milliseconds

double areaOf(const Vec3& a, const Vec3& b, const Vec3& c) {
  return 0.5 * (b - a).cross(c - a).norm();
}

std::vector<std::array<Index, 3>> minimalArea(const std::vector<Vec3>& loop,
                                              const std::vector<Index>& ring) {
  const std::size_t n = ring.size();
  const auto p = [&](std::size_t i) -> const Vec3& {
    return loop[static_cast<std::size_t>(ring[i])];
  };
  std::vector<double> cost(n * n, 0);
  std::vector<std::size_t> apex(n * n, 0);
  for (std::size_t length = 2; length < n; ++length) {
    for (std::size_t i = 0; i + length < n; ++i) {
      const std::size_t k = i + length;
      double best = std::numeric_limits<double>::infinity();
      for (std::size_t m = i + 1; m < k; ++m) {
        const double c = cost[i * n + m] + cost[m * n + k] + areaOf(p(i), p(m), p(k));
        if (c < best) {
          best = c;
          apex[i * n + k] = m;
        }
      }
      cost[i * n + k] = best;
    }
  }
  std::vector<std::array<Index, 3>> triangles;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, n - 1}};
  while (!open.empty()) {
    const auto [i, k] = open.back();
    open.pop_back();
    if (k - i < 2) continue;
    const std::size_t m = apex[i * n + k];
    if (m <= i || m >= k) return {};  // not finite
    triangles.push_back({ring[i], ring[m], ring[k]});
    open.emplace_back(i, m);
    open.emplace_back(m, k);
  }
  return triangles;
}

}  // namespace

std::vector<std::array<Index, 3>> triangulateLoop(const std::vector<Vec3>& loop) {
  if (loop.size() < 3) return {};
  std::vector<Index> ring(loop.size());
  std::iota(ring.begin(), ring.end(), 0);
  std::vector<std::array<Index, 3>> triangles;
  while (ring.size() > kExactLimit) {
    const std::size_t n = ring.size();
    std::size_t smallest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i) {
      const auto p = [&](std::size_t j) { return loop[static_cast<std::size_t>(ring[j % n])]; };
      const double a = areaOf(p(i + n - 1), p(i), p(i + 1));
      if (a < least) {
        least = a;
        smallest = i;
      }
    }
    triangles.push_back({ring[(smallest + n - 1) % n], ring[smallest], ring[(smallest + 1) % n]});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(smallest));
  }
  for (const auto& t : minimalArea(loop, ring)) triangles.push_back(t);
  return triangles;
}

}  // namespace phront::cad
