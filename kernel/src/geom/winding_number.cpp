// Winding number w(x) = sum of the signed solid angles of all triangles / 4 pi (Jacobson, Kavan,
// Sorkine-Hornung 2013; solid angle after van Oosterom & Strackee 1983). Clusters farther than
// kFarField radii count by the first two terms of their Taylor expansion (Barill et al. 2018).
// What is left out is second order in radius / distance. In the middle of a sphere, where the
// errors of all clusters add up, it was measured to reach 0.066 with a ratio of 2 and 0.016 with 4:
// enough to tell 0 from 1, which is all it is used for. On closed meshes the number is whole: the
// ratio of 2 does where its result is near to one.
#include "geom/winding_number.h"

#include <cmath>
#include <numbers>

namespace phront {

namespace {

constexpr double kFarField = 4.0;  // see above
constexpr double kHasty = 2.0;
constexpr double kNearWhole = 0.2;

double solidAngle(const QueryTriangle& t, const Vec3& x) {
  const Vec3 a = t.corners[0] - x;
  const Vec3 b = t.corners[1] - x;
  const Vec3 c = t.corners[2] - x;
  const double la = a.norm();
  const double lb = b.norm();
  const double lc = c.norm();
  const double numerator = a.dot(b.cross(c));
  const double denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return 2 * std::atan2(numerator, denominator);
}

}  // namespace

WindingTree::WindingTree(const Bvh& bvh, std::span<const QueryTriangle> triangles)
    : moments_(bvh.nodes().size()) {
  std::vector<double> areas(moments_.size(), 0);
  // Children have larger numbers than their parent: going backwards, they are ready.
  for (std::size_t n = moments_.size(); n-- > 0;) {
    const Bvh::Node& node = bvh.nodes()[n];
    Moment& m = moments_[n];
    const Vec3 middle = (node.low + node.high) / 2;
    Vec3 weighted = Vec3::Zero();
    auto centroid = [](const QueryTriangle& t) {
      return Vec3((t.corners[0] + t.corners[1] + t.corners[2]) / 3);
    };
    auto areaNormal = [](const QueryTriangle& t) {
      return Vec3((t.corners[1] - t.corners[0]).cross(t.corners[2] - t.corners[0]) / 2);
    };
    if (node.count > 0) {
      const auto own = triangles.subspan(static_cast<std::size_t>(node.first),
                                         static_cast<std::size_t>(node.count));
      for (const QueryTriangle& t : own) {
        const Vec3 an = areaNormal(t);
        areas[n] += an.norm();
        weighted += an.norm() * (centroid(t) - middle);
        m.dipole += an;
      }
      m.centre = areas[n] > 0 ? Vec3(middle + weighted / areas[n]) : middle;
      for (const QueryTriangle& t : own) {
        m.spread += (centroid(t) - m.centre) * areaNormal(t).transpose();
      }
    } else {
      for (const Index child : {node.first, node.first + 1}) {
        const auto c = static_cast<std::size_t>(child);
        areas[n] += areas[c];
        weighted += areas[c] * (moments_[c].centre - middle);
        m.dipole += moments_[c].dipole;
      }
      m.centre = areas[n] > 0 ? Vec3(middle + weighted / areas[n]) : middle;
      for (const Index child : {node.first, node.first + 1}) {
        const Moment& c = moments_[static_cast<std::size_t>(child)];
        m.spread += c.spread + (c.centre - m.centre) * c.dipole.transpose();
      }
    }
    m.radius = (m.centre - node.low).cwiseMax(node.high - m.centre).norm();
  }
}

double WindingTree::at(const Vec3& x, const Bvh& bvh,
                       std::span<const QueryTriangle> triangles) const {
  return sum(x, bvh, triangles, kFarField);
}

int WindingTree::timesAround(const Vec3& x, const Bvh& bvh,
                             std::span<const QueryTriangle> triangles) const {
  const double hasty = sum(x, bvh, triangles, kHasty);
  const bool sure = std::abs(hasty - std::round(hasty)) < kNearWhole;
  return static_cast<int>(std::round(sure ? hasty : sum(x, bvh, triangles, kFarField)));
}

double WindingTree::sum(const Vec3& x, const Bvh& bvh, std::span<const QueryTriangle> triangles,
                        double farField) const {
  if (moments_.empty()) return 0;
  double angle = 0;
  std::array<Index, Bvh::kMaxDepth + 2> stack;
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const auto n = static_cast<std::size_t>(stack[--size]);
    const Bvh::Node& node = bvh.nodes()[n];
    const Moment& m = moments_[n];
    const Vec3 r = m.centre - x;
    const double distance = r.norm();
    if (distance > farField * m.radius) {
      const double cube = distance * distance * distance;
      angle += r.dot(m.dipole) / cube + m.spread.trace() / cube -
               3 * r.dot(m.spread * r) / (cube * distance * distance);
    } else if (node.count > 0) {
      for (Index i = 0; i < node.count; ++i) {
        angle += solidAngle(triangles[static_cast<std::size_t>(node.first + i)], x);
      }
    } else {
      stack[size++] = node.first + 1;
      stack[size++] = node.first;
    }
  }
  return angle / (4 * std::numbers::pi);
}

}  // namespace phront
