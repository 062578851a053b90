// Closest point of one triangle, in double precision and safe on slivers.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/lanes.h"
#include "phront/types.h"

namespace phront {

/// A triangle ready for closest-point queries.
struct QueryTriangle {
  std::array<Vec3, 3> corners;
  Vec3 normal = Vec3::Zero();  ///< unit; zero when degenerate
  Index id = kNone;
  /// Bit k: side k is evaluated from its end to its start. Both triangles on an edge evaluate it
  /// from the smaller point index on, so they get the same bits and ties are true ties.
  std::uint8_t reversed = 0;
  bool wellShaped = false;
};

/// Smallest height over longest side below which a triangle has no interior in double precision.
inline constexpr double kDegenerateHeight = 1e-14;
/// Height over longest side above which the unit normal is good to a few ulps, so that projecting
/// along it is more exact than summing weighted corners. On thinner triangles it is the reverse.
inline constexpr double kWellShapedHeight = 0.05;

[[nodiscard]] inline QueryTriangle makeQueryTriangle(const std::array<Vec3, 3>& corners,
                                                     const std::array<Index, 3>& points, Index id) {
  QueryTriangle t;
  t.corners = corners;
  t.id = id;
  double longest = -1;
  std::size_t opposite = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (points[k] > points[(k + 1) % 3]) t.reversed |= static_cast<std::uint8_t>(1U << k);
    const double length = (corners[(k + 1) % 3] - corners[k]).norm();
    if (length > longest) {
      longest = length;
      opposite = (k + 2) % 3;
    }
  }
  // The two shorter sides lose the fewest digits in the cross product.
  const Vec3 u = corners[(opposite + 1) % 3] - corners[opposite];
  const Vec3 v = corners[(opposite + 2) % 3] - corners[opposite];
  const Vec3 cross = u.cross(v);
  const double twiceArea = cross.norm();
  const double height = twiceArea / longest;
  if (!(height > kDegenerateHeight * longest)) return t;
  t.normal = cross / twiceArea;
  t.wellShaped = height > kWellShapedHeight * longest;
  return t;
}

/// Coordinates and lengths beyond are refused: their squares would overflow and no foot be found.
inline constexpr double kFarthest = 1e150;

struct TriangleFoot {
  Vec3 point;
  double squared = std::numeric_limits<double>::infinity();
  Vec3 barycentric;
  FeatureKind kind = FeatureKind::Face;
  Index corner = 0;
};

namespace detail {

inline double squaredGap(const Vec3& x, const Vec3& f) {
  const Vec3 g = x - f;
  return g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
}

inline void closestOnSide(const QueryTriangle& t, std::size_t k, const Vec3& x,
                          TriangleFoot& best) {
  const bool reversed = (t.reversed >> k & 1U) != 0;
  const std::size_t end = (k + 1) % 3;
  const std::size_t from = reversed ? end : k;
  const std::size_t to = reversed ? k : end;
  const Vec3& p = t.corners[from];
  const Vec3& q = t.corners[to];
  const Vec3 e = q - p;
  const double along = e.dot(x - p);
  const double length = e.squaredNorm();
  const bool atStart = !(along > 0);
  const bool atEnd = !atStart && along >= length;
  Vec3 point = p;
  double w = 0;
  if (atEnd) {
    point = q;
    w = 1;
  } else if (!atStart) {
    w = along / length;
    point = (p + w * e).cwiseMax(p.cwiseMin(q)).cwiseMin(p.cwiseMax(q));
  }
  const double squared = squaredGap(x, point);
  if (!(squared < best.squared)) return;
  best.squared = squared;
  best.point = point;
  best.barycentric.setZero();
  best.barycentric[static_cast<Eigen::Index>(from)] = 1 - w;
  best.barycentric[static_cast<Eigen::Index>(to)] = w;
  best.kind = atStart || atEnd ? FeatureKind::Vertex : FeatureKind::Edge;
  best.corner = static_cast<Index>(atStart ? from : atEnd ? to : k);
}

}  // namespace detail

/// The plane of a triangle, seen from a point: T is a number, or several side by side for as many
/// points. Same bits for either.
template <class T>
struct AboveFace {
  std::array<T, 3> weight;  ///< of each corner: twice the area opposite; all > 0: over the face
  std::array<T, 3> point;   ///< foot along the normal, moved into the triangle's bounding box
  T squared;                ///< distance to that point
  T height;                 ///< the same along the normal: its sign tells the side
};

namespace detail {

template <class T, class A, class B>
PHRONT_INLINE T dot(const A& a, const B& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// normal . ((to - from) x (x - from))
template <class T>
PHRONT_INLINE T areaLeftOf(const Vec3& normal, const Vec3& from, const Vec3& to,
                           const std::array<T, 3>& x) {
  const double e0 = to[0] - from[0];
  const double e1 = to[1] - from[1];
  const double e2 = to[2] - from[2];
  const T v0 = x[0] - from[0];
  const T v1 = x[1] - from[1];
  const T v2 = x[2] - from[2];
  return normal[0] * (e1 * v2 - e2 * v1) + normal[1] * (e2 * v0 - e0 * v2) +
         normal[2] * (e0 * v1 - e1 * v0);
}

}  // namespace detail

/// Where the face lies under x; the foot is right when all weights are positive and the triangle is
/// well shaped.
template <class T>
PHRONT_INLINE AboveFace<T> aboveFace(const QueryTriangle& t, const std::array<T, 3>& x) {
  const auto& [a, b, c] = t.corners;
  AboveFace<T> result;
  result.weight[0] = detail::areaLeftOf<T>(t.normal, b, c, x);
  result.weight[1] = detail::areaLeftOf<T>(t.normal, c, a, x);
  result.weight[2] = detail::areaLeftOf<T>(t.normal, a, b, x);
  std::array<T, 3> v;
  for (std::size_t axis = 0; axis < 3; ++axis)
    v[axis] = x[axis] - a[static_cast<Eigen::Index>(axis)];
  const T offPlane = detail::dot<T>(v, t.normal);
  std::array<T, 3> gap;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<Eigen::Index>(axis);
    const T low = T{} + std::min({a[n], b[n], c[n]});
    const T high = T{} + std::max({a[n], b[n], c[n]});
    result.point[axis] = minOf<T>(maxOf<T>(x[axis] - offPlane * t.normal[n], low), high);
    gap[axis] = x[axis] - result.point[axis];
  }
  result.squared = detail::dot<T>(gap, gap);
  result.height = detail::dot<T>(gap, t.normal);
  return result;
}

/// Closest point of t to x. The foot lies inside the triangle's bounding box to the last bit (see
/// Bvh::squaredDistance), and its distance is measured to that very foot: rounding can never make a
/// triangle look nearer than it is by more than the rounding of the foot itself.
[[nodiscard]] inline TriangleFoot closestOnTriangle(const QueryTriangle& t, const Vec3& x) {
  TriangleFoot foot;
  const AboveFace<double> above = aboveFace<double>(t, {x[0], x[1], x[2]});
  const auto [wa, wb, wc] = above.weight;
  if (wa > 0 && wb > 0 && wc > 0) {
    foot.barycentric = Vec3(wa, wb, wc) / (wa + wb + wc);
    if (t.wellShaped) {
      foot.point = Vec3(above.point[0], above.point[1], above.point[2]);
      foot.squared = above.squared;
      return foot;
    }
    const auto& [a, b, c] = t.corners;
    const Vec3 raw = foot.barycentric[0] * a + foot.barycentric[1] * b + foot.barycentric[2] * c;
    foot.point = raw.cwiseMax(a.cwiseMin(b).cwiseMin(c)).cwiseMin(a.cwiseMax(b).cwiseMax(c));
    foot.squared = detail::squaredGap(x, foot.point);
    return foot;
  }
  for (std::size_t k = 0; k < 3; ++k) detail::closestOnSide(t, k, x, foot);
  return foot;
}

}  // namespace phront
