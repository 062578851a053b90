// Triangles of least area take O(n^3): longer loops lose their smallest ear until they are short
// enough.
#include "tessellate/triangulate_loop.h"

#include <limits>
#include <numeric>

#include "phront/least_area.h"

namespace phront::cad {
namespace {

constexpr std::size_t kExactLimit = 160;  // points; n^3 / 6 areas stay in the milliseconds

double areaOf(const Vec3& a, const Vec3& b, const Vec3& c) {
  return 0.5 * (b - a).cross(c - a).norm();
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
  for (const auto& t : leastAreaTriangles(ring, loop, Flat::Allowed)) triangles.push_back(t);
  return triangles;
}

}  // namespace phront::cad
