// Closest point of one triangle, in double precision and safe on slivers.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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

/// Closest point of t to x. The foot lies inside the triangle's bounding box to the last bit (see
/// Bvh::squaredDistance), and its distance is measured to that very foot: rounding can never make a
/// triangle look nearer than it is by more than the rounding of the foot itself.
[[nodiscard]] inline TriangleFoot closestOnTriangle(const QueryTriangle& t, const Vec3& x) {
  TriangleFoot foot;
  const Vec3& a = t.corners[0];
  const Vec3& b = t.corners[1];
  const Vec3& c = t.corners[2];
  const double wc = t.normal.dot((b - a).cross(x - a));
  const double wa = t.normal.dot((c - b).cross(x - b));
  const double wb = t.normal.dot((a - c).cross(x - c));
  if (wa > 0 && wb > 0 && wc > 0) {
    foot.barycentric = Vec3(wa, wb, wc) / (wa + wb + wc);
    const Vec3 raw =
        t.wellShaped
            ? Vec3(x - t.normal.dot(x - a) * t.normal)
            : Vec3(foot.barycentric[0] * a + foot.barycentric[1] * b + foot.barycentric[2] * c);
    foot.point = raw.cwiseMax(a.cwiseMin(b).cwiseMin(c)).cwiseMin(a.cwiseMax(b).cwiseMax(c));
    foot.squared = detail::squaredGap(x, foot.point);
    return foot;
  }
  for (std::size_t k = 0; k < 3; ++k) detail::closestOnSide(t, k, x, foot);
  return foot;
}

}  // namespace phront
