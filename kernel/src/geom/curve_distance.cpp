// Closest point by the hierarchy of the segments' boxes (the one for triangles, at z = 0). The sign
// of closed curves is the winding number: crossings of the ray to the right, half-open in y so that
// a vertex counts once. A point on the curve has distance 0 and either sign. Weak spot: within
// round-off of a curve the sign of the winding number is as good as that of one determinant.
#include "phront/curve_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include "geom/bvh.h"

namespace phront {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

Vec3 inSpace(const Vec2& p) { return {p.x(), p.y(), 0}; }

}  // namespace

struct CurveDistance::Impl {
  CurveMesh mesh;
  Bvh bvh;
  Eigen::AlignedBox2d box;
  bool closed = false;
  std::vector<std::array<Index, 2>> segmentsAt;  // per point, one that arrives, one that leaves

  [[nodiscard]] const Vec2& from(Index s) const { return mesh.points[at(mesh.segments[at(s)][0])]; }
  [[nodiscard]] const Vec2& to(Index s) const { return mesh.points[at(mesh.segments[at(s)][1])]; }

  /// Unit normal towards phi > 0, to the right; zero for segments of length zero.
  [[nodiscard]] Vec2 normal(Index s) const {
    const Vec2 along = (to(s) - from(s)).normalized();
    return {along.y(), -along.x()};
  }

  void index() {
    std::vector<Box3> boxes;
    std::vector<int> balance(mesh.points.size(), 0);
    segmentsAt.assign(mesh.points.size(), {kNone, kNone});
    for (std::size_t s = 0; s < mesh.segments.size(); ++s) {
      const auto& [a, b] = mesh.segments[s];
      Box3 segmentBox(inSpace(mesh.points[at(a)]));
      segmentBox.extend(inSpace(mesh.points[at(b)]));
      boxes.push_back(segmentBox);
      box.extend(mesh.points[at(a)]);
      box.extend(mesh.points[at(b)]);
      ++balance[at(a)];
      --balance[at(b)];
      segmentsAt[at(b)][0] = static_cast<Index>(s);
      segmentsAt[at(a)][1] = static_cast<Index>(s);
    }
    closed = true;
    for (const int b : balance) closed = closed && b == 0;
    std::vector<Index> items(boxes.size());
    std::iota(items.begin(), items.end(), 0);
    bvh = Bvh(boxes, std::move(items));
  }

  [[nodiscard]] CurveFoot footOn(Index s, const Vec2& x) const {
    const Vec2 along = to(s) - from(s);
    const double squared = along.squaredNorm();
    CurveFoot foot;
    foot.segment = s;
    if (squared > 0) foot.parameter = std::clamp((x - from(s)).dot(along) / squared, 0.0, 1.0);
    foot.point = foot.parameter < 1 ? Vec2(from(s) + foot.parameter * along) : to(s);
    foot.distance = (x - foot.point).norm();
    return foot;
  }

  /// Side of an open curve; at a vertex that of the mean normal of its two segments.
  void takeSide(CurveFoot& foot, const Vec2& x) const {
    Vec2 towards = normal(foot.segment);
    const bool atStart = foot.parameter <= 0;
    if (atStart || foot.parameter >= 1) {
      const Index point = mesh.segments[at(foot.segment)][atStart ? 0 : 1];
      const Index other = segmentsAt[at(point)][atStart ? 0 : 1];
      if (other != kNone) {
        towards += normal(other);
      } else {
        const Vec2 along = to(foot.segment) - from(foot.segment);
        foot.beyondBorder = (x - foot.point).dot(along) != 0;
      }
    }
    foot.sign = towards.dot(x - foot.point) < 0 ? -1 : 1;
  }
};

Result<CurveDistance> CurveDistance::build(CurveMesh mesh) {
  if (mesh.segments.empty()) {
    return fail(ErrorCode::InvalidArgument, "The curves have no segments.", "segments");
  }
  for (const Vec2& p : mesh.points) {
    if (!p.allFinite()) {
      return fail(ErrorCode::InvalidArgument, "A point of the curves is not finite.", "points");
    }
  }
  const auto count = static_cast<Index>(mesh.points.size());
  for (const auto& [a, b] : mesh.segments) {
    if (a < 0 || b < 0 || a >= count || b >= count) {
      return fail(ErrorCode::InvalidArgument, "A segment names a point that is not there.",
                  "segments");
    }
  }
  if (!mesh.curveOf.empty() && mesh.curveOf.size() != mesh.segments.size()) {
    return fail(ErrorCode::InvalidArgument, "There must be one curve number per segment.",
                "curveOf");
  }
  auto impl = std::make_unique<Impl>();
  impl->mesh = std::move(mesh);
  impl->index();
  return CurveDistance(std::move(impl));
}

const CurveMesh& CurveDistance::mesh() const { return impl_->mesh; }
bool CurveDistance::closed() const { return impl_->closed; }
Eigen::AlignedBox2d CurveDistance::box() const { return impl_->box; }

CurveFoot CurveDistance::foot(const Vec2& x, double reach) const {
  const Impl& s = *impl_;
  CurveFoot best;
  double squared = reach * reach;
  s.bvh.nearest(
      inSpace(x),
      [&](Index position) {
        const Index segment = s.bvh.order()[at(position)];
        const CurveFoot foot = s.footOn(segment, x);
        if (foot.distance > reach) return;
        // Equal distances: the smaller number, whatever the order of the walk.
        if (foot.distance < best.distance ||
            (foot.distance == best.distance && segment < best.segment)) {
          best = foot;
          squared = (x - foot.point).squaredNorm();
        }
      },
      [&] { return squared; });
  if (best.segment == kNone) return best;
  if (s.closed) {
    best.sign = windingNumber(x) != 0 ? -1 : 1;
  } else {
    s.takeSide(best, x);
  }
  return best;
}

CurveFoot CurveDistance::footAlong(const Vec2& x, Index segment) const {
  const Impl& s = *impl_;
  CurveFoot foot = s.footOn(segment, x);
  for (std::size_t step = 0; step < s.mesh.segments.size(); ++step) {
    if (foot.parameter > 0 && foot.parameter < 1) break;
    const bool atStart = foot.parameter <= 0;
    const Index point = s.mesh.segments[at(foot.segment)][atStart ? 0 : 1];
    const Index next = s.segmentsAt[at(point)][atStart ? 0 : 1];
    if (next == kNone) break;
    const CurveFoot there = s.footOn(next, x);
    if (!(there.distance < foot.distance)) break;
    foot = there;
  }
  return foot;
}

Vec2 CurveDistance::gradient(const Vec2& x, const CurveFoot& foot) const {
  if (foot.segment == kNone) return Vec2::Zero();
  if (foot.distance > 0) return foot.sign * (x - foot.point) / foot.distance;
  return impl_->normal(foot.segment);
}

int CurveDistance::windingNumber(const Vec2& x) const {
  const Impl& s = *impl_;
  int winding = 0;
  std::array<Index, Bvh::kMaxDepth + 2> stack;
  std::size_t size = 0;
  if (!s.bvh.nodes().empty()) stack[size++] = 0;
  while (size > 0) {
    const Bvh::Node& node = s.bvh.nodes()[at(stack[--size])];
    if (x.y() < node.low.y() || x.y() > node.high.y() || x.x() > node.high.x()) continue;
    if (node.count == 0) {
      stack[size++] = node.first;
      stack[size++] = node.first + 1;
      continue;
    }
    for (Index i = 0; i < node.count; ++i) {
      const Index segment = s.bvh.order()[at(node.first + i)];
      const Vec2& a = s.from(segment);
      const Vec2& b = s.to(segment);
      const bool up = a.y() <= x.y() && x.y() < b.y();
      const bool down = b.y() <= x.y() && x.y() < a.y();
      if (!up && !down) continue;
      // The crossing lies to the right when x is to the left of the segment run upwards.
      const double side = cross(b - a, x - a);
      if (up && side > 0) ++winding;
      if (down && side < 0) --winding;
    }
  }
  return winding;
}

CurveDistance::CurveDistance(std::unique_ptr<const Impl> impl) : impl_(std::move(impl)) {}
CurveDistance::CurveDistance(CurveDistance&&) noexcept = default;
CurveDistance& CurveDistance::operator=(CurveDistance&&) noexcept = default;
CurveDistance::~CurveDistance() = default;

}  // namespace phront
