// The front is found on a grid and made exact afterwards: marching squares give its lines, each
// point is moved along its grid edge to phi = d (the signs at the edge's ends bracket it), corners
// are put where fronts of two branches meet (Newton on both distances), slits thinner than a cell
// are followed to their end, and points that the tolerance does not need go (Douglas and Peucker
// 1973). Only blocks of nodes near the front are asked: phi is 1-Lipschitz. Weak spots: two corners
// in one cell of the grid become one; a channel thinner than a cell that leads from one wide part
// to another is closed.
#include "phront/offset_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "phront/iso_curve.h"

namespace phront {
namespace {

constexpr double kToleranceOfDistance = 1e-3;
constexpr double kFinestOfDistance = 1.0 / 64;  // h, whatever the tolerance
constexpr double kCoarsestOfDistance = 0.25;    // h: roundings must be seen
// Of the tolerance: chords along an axis of the grid (twice that on diagonals); thinning.
constexpr double kChordShare = 0.2;
constexpr double kThinShare = 0.5;
constexpr double kLeastTurn = 1e-3;        // rad between the fronts at a corner
constexpr double kTouchOfTolerance = 0.1;  // fronts this near to one another touch
constexpr double kSlitStep = 0.25;         // of h, along fronts in slits
constexpr int kMostSlitSteps = 400;
constexpr double kCornerOfTolerance = 0.05;  // corners less high are none
constexpr double kRootOfSpacing = 1e-13;
constexpr int kBisections = 60;
constexpr int kNewtonSteps = 20;
constexpr int kBlock = 16;          // nodes a side asked together
constexpr std::int64_t kGrain = 1;  // rows of blocks per task

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

class CurveOffsetter {
 public:
  CurveOffsetter(const CurveDistance& curves, const OffsetCurveOptions& options)
      : curves_(curves),
        options_(options),
        distance_(options.distance),
        tolerance_(options.tolerance.value_or(kToleranceOfDistance * std::abs(options.distance))) {
    // A chord of length h on an arc of radius |d| is off by h^2 / 8|d|.
    const double d = std::abs(distance_);
    const double h = std::sqrt(8 * kChordShare * tolerance_ * d);
    grid_.spacing = std::clamp(h, kFinestOfDistance * d, kCoarsestOfDistance * d);
  }

  Result<OffsetCurve> run(const Progress& progress) {
    if (auto ok = layGrid(); !ok) return tl::unexpected(ok.error());
    if (!progress.report(0)) return fail(ErrorCode::Cancelled, "Cancelled.");
    fillValues();
    if (!progress.report(0.6)) return fail(ErrorCode::Cancelled, "Cancelled.");
    auto lines = isoCurve(grid_, values_, distance_);
    if (!lines) return tl::unexpected(lines.error());
    OffsetCurve result;
    result.spacing = grid_.spacing;
    result.curves = std::move(*lines);
    moveToLevel(result.curves);
    addCorners(result.curves);
    result.curves = thinned(result.curves);
    result.deviation = deviation(result.curves);
    if (!progress.report(1)) return fail(ErrorCode::Cancelled, "Cancelled.");
    return result;
  }

 private:
  Result<void> layGrid() {
    const Vec2 margin = Vec2::Constant(std::max(distance_, 0.0) + 2 * grid_.spacing);
    const Vec2 low = curves_.box().min() - margin;
    const Vec2 size = curves_.box().max() + margin - low;
    double nodes = 1;
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const double count = std::ceil(size[axis] / grid_.spacing) + 1;
      nodes *= count;
      if (nodes > static_cast<double>(options_.maxNodes)) {
        return fail(ErrorCode::ResourceLimit,
                    fmt::format("The grid would need more than {} nodes: the distance or the "
                                "tolerance is too small for curves of this size.",
                                options_.maxNodes),
                    "distance");
      }
      grid_.nodes[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(count);
    }
    grid_.nodes[2] = 1;
    grid_.origin = Vec3(low.x(), low.y(), 0);
    return {};
  }

  [[nodiscard]] double phi(const Vec2& x) const { return curves_.signedDistance(x); }

  /// phi at all nodes of blocks that the front may touch; elsewhere a value on the right side of d.
  void fillValues() {
    values_.resize(static_cast<std::size_t>(grid_.nodeCount()));
    const auto blocks = [](std::int32_t n) { return (n + kBlock - 1) / kBlock; };
    // Half the diagonal of a block of nodes, and a cell, across which lines may run on.
    const double radius = (std::sqrt(0.5) * (kBlock - 1) + std::sqrt(2.0)) * grid_.spacing;
    parallelFor(blocks(grid_.nodes[1]), options_.threads, kGrain,
                [&](std::int64_t begin, std::int64_t end) {
                  for (auto b = static_cast<std::int32_t>(begin); b < end; ++b) {
                    for (std::int32_t a = 0; a < blocks(grid_.nodes[0]); ++a) {
                      fillBlock(kBlock * a, kBlock * b, radius);
                    }
                  }
                });
  }

  void fillBlock(std::int32_t i0, std::int32_t j0, double radius) {
    const double half = 0.5 * (kBlock - 1) * grid_.spacing;
    const double middle = phi(grid_.position(i0, j0).head<2>() + Vec2(half, half));
    // Open curves: phi jumps behind their ends, its magnitude does not.
    const bool far = curves_.closed() ? std::abs(middle - distance_) > radius
                                      : std::abs(std::abs(middle) - std::abs(distance_)) > radius;
    for (std::int32_t j = j0; j < std::min(j0 + kBlock, grid_.nodes[1]); ++j) {
      for (std::int32_t i = i0; i < std::min(i0 + kBlock, grid_.nodes[0]); ++i) {
        values_[static_cast<std::size_t>(grid_.number(i, j))] =
            far ? middle : valueAt(grid_.position(i, j).head<2>());
      }
    }
  }

  /// Infinity beyond the ends of open curves: fronts stop there.
  [[nodiscard]] double valueAt(const Vec2& x) const {
    const CurveFoot foot = curves_.foot(x);
    return foot.beyondBorder ? std::numeric_limits<double>::infinity() : foot.phi();
  }

  /// Each point lies on an edge of the grid whose ends have phi on both sides of d.
  void moveToLevel(CurveMesh& lines) const {
    parallelFor(static_cast<std::int64_t>(lines.points.size()), options_.threads, 64,
                [&](std::int64_t begin, std::int64_t end) {
                  for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end);
                       ++i) {
                    lines.points[i] = onLevel(lines.points[i]);
                  }
                });
  }

  [[nodiscard]] Vec2 onLevel(const Vec2& p) const {
    // The axis along which p is off the nodes.
    const Vec2 u = (p - grid_.origin.head<2>()) / grid_.spacing;
    const Vec2 off = (u - u.array().round().matrix()).cwiseAbs();
    const Eigen::Index axis = off.x() > off.y() ? 0 : 1;
    Vec2 low = p;
    Vec2 high = p;
    low[axis] = grid_.origin[axis] + grid_.spacing * std::floor(u[axis]);
    high[axis] = low[axis] + grid_.spacing;
    double atLow = phi(low) - distance_;
    double atHigh = phi(high) - distance_;
    if ((atLow < 0) == (atHigh < 0)) return p;
    for (int i = 0; i < kBisections && (high - low).norm() > kRootOfSpacing * grid_.spacing; ++i) {
      // phi is linear along the edge but for curvature and corners: the secant, kept off the ends.
      const double t = std::clamp(atLow / (atLow - atHigh), 0.02, 0.98);
      const Vec2 x = low + (i % 3 == 2 ? 0.5 : t) * (high - low);
      const double value = phi(x) - distance_;
      if (value == 0) return x;
      if ((value < 0) == (atLow < 0)) {
        low = x;
        atLow = value;
      } else {
        high = x;
        atHigh = value;
      }
    }
    return std::abs(atLow) < std::abs(atHigh) ? low : high;
  }

  /// A point more in each side over which fronts of two branches of the curves meet.
  void addCorners(CurveMesh& lines) const {
    std::vector<CurveFoot> feet;
    for (const Vec2& p : lines.points) feet.push_back(curves_.foot(p));
    const std::size_t count = lines.segments.size();
    std::vector<std::array<Index, 2>> segments;
    std::vector<Index> curveOf;
    for (std::size_t s = 0; s < count; ++s) {
      const auto [a, b] = lines.segments[s];
      Index from = a;
      for (const Vec2& x :
           between(lines.points[at(a)], feet[at(a)], lines.points[at(b)], feet[at(b)])) {
        const auto to = static_cast<Index>(lines.points.size());
        lines.points.push_back(x);
        segments.push_back({from, to});
        from = to;
      }
      segments.push_back({from, b});
      curveOf.resize(segments.size(), lines.curveOf[s]);
    }
    lines.segments = std::move(segments);
    lines.curveOf = std::move(curveOf);
  }

  /// The points of the front that a side from p to q lacks.
  [[nodiscard]] std::vector<Vec2> between(const Vec2& p, const CurveFoot& footP, const Vec2& q,
                                          const CurveFoot& footQ) const {
    if (footP.segment == footQ.segment) return {};
    if (const auto corner = cornerBetween(p, footP, q, footQ)) return {*corner};
    const auto off = [&](const Vec2& x) {
      return std::abs(curves_.foot(x).distance - std::abs(distance_));
    };
    if (off(0.5 * (p + q)) <= kThinShare * tolerance_) return {};
    const Vec2 tangentP = tangent(p, footP);
    const Vec2 tangentQ = tangent(q, footQ);
    // Fronts of a whole arc that meet in its centre: the ends of the side know where it lies.
    const double turn = tangentP.x() * tangentQ.y() - tangentP.y() * tangentQ.x();
    if (std::abs(turn) > kLeastTurn) {
      const Vec2 gap = q - p;
      const Vec2 x = p + (gap.x() * tangentQ.y() - gap.y() * tangentQ.x()) / turn * tangentP;
      if ((x - p).norm() < 2 * grid_.spacing && off(x) <= kTouchOfTolerance * tolerance_) {
        return {x};
      }
    }
    return throughSlit(p, footP, q, footQ);
  }

  /// Along the front, material to the left.
  [[nodiscard]] Vec2 tangent(const Vec2& x, const CurveFoot& foot) const {
    const Vec2 g = curves_.gradient(x, foot);
    return {-g.y(), g.x()};
  }

  /// On the front of the branch of `foot`, one step on (or back).
  [[nodiscard]] Vec2 stepAlong(const Vec2& x, double step, CurveFoot& foot) const {
    const double side = distance_ > 0 ? 1 : -1;  // of the gradient from the foot
    const Vec2 out = side * (x - foot.point).normalized();
    const Vec2 next = x + step * Vec2(-out.y(), out.x());
    foot = curves_.footAlong(next, foot.segment);
    if (!(foot.distance > 0)) return next;
    return foot.point + std::abs(distance_) / foot.distance * (next - foot.point);
  }

  /// Fronts nearer to one another than the grid can see: follows that of p to where that of q meets
  /// it, and comes back along that.
  [[nodiscard]] std::vector<Vec2> throughSlit(const Vec2& p, const CurveFoot& footP, const Vec2& q,
                                              const CurveFoot& footQ) const {
    const double step = kSlitStep * grid_.spacing;
    const double wanted = std::abs(distance_);
    const double touch = wanted + kTouchOfTolerance * tolerance_;
    std::vector<Vec2> points;
    Vec2 x = p;
    CurveFoot own = footP;
    CurveFoot other = footQ;
    bool met = false;
    for (int i = 0; i < kMostSlitSteps && !met; ++i) {
      x = stepAlong(x, step, own);
      other = curves_.footAlong(x, other.segment);
      met = other.distance <= touch;
      if (curves_.foot(x).distance < wanted - tolerance_) {
        if (!met) return {};  // a third branch is in the way
        break;                // between this step and the one before
      }
      points.push_back(x);
    }
    if (!met || points.empty()) return {};
    std::vector<Vec2> back;
    x = q;
    own = footQ;
    for (int i = 0; i < kMostSlitSteps; ++i) {
      x = stepAlong(x, -step, own);
      if ((x - points.back()).norm() <= step) break;
      if (curves_.foot(x).distance < wanted - tolerance_) break;
      back.push_back(x);
    }
    points.insert(points.end(), back.rbegin(), back.rend());
    return points;
  }

  /// Where the fronts of the two points' own segments cross.
  [[nodiscard]] std::optional<Vec2> cornerBetween(const Vec2& p, const CurveFoot& footP,
                                                  const Vec2& q, const CurveFoot& footQ) const {
    if (footP.segment == footQ.segment) return std::nullopt;
    const double wanted = std::abs(distance_);
    const Vec2 middle = 0.5 * (p + q);
    Vec2 x = middle;
    CurveFoot a = footP;
    CurveFoot b = footQ;
    for (int i = 0; i < kNewtonSteps; ++i) {
      a = curves_.footAlong(x, a.segment);
      b = curves_.footAlong(x, b.segment);
      if (!(a.distance > 0) || !(b.distance > 0)) return std::nullopt;
      Eigen::Matrix2d slope;
      slope.row(0) = (x - a.point) / a.distance;
      slope.row(1) = (x - b.point) / b.distance;
      const Vec2 error(a.distance - wanted, b.distance - wanted);
      if (std::abs(slope.determinant()) < kLeastTurn) return std::nullopt;  // one branch
      const Vec2 step = slope.inverse() * error;
      x -= step;
      if ((x - middle).norm() > 2 * grid_.spacing) return std::nullopt;
      if (step.norm() <= kRootOfSpacing * grid_.spacing) break;
    }
    const Vec2 along = (q - p).normalized();
    const Vec2 off = x - p - (x - p).dot(along) * along;
    if (off.norm() < kCornerOfTolerance * tolerance_) return std::nullopt;
    // It counts if no third branch is nearer.
    if (std::abs(phi(x) - distance_) > 1e-9 * wanted) return std::nullopt;
    return x;
  }

  /// Lines without the points that the tolerance does not need.
  [[nodiscard]] CurveMesh thinned(const CurveMesh& lines) const {
    std::vector<Index> leaving(lines.points.size(), kNone);
    std::vector<Index> arriving(lines.points.size(), kNone);
    for (std::size_t s = 0; s < lines.segments.size(); ++s) {
      leaving[at(lines.segments[s][0])] = static_cast<Index>(s);
      arriving[at(lines.segments[s][1])] = static_cast<Index>(s);
    }
    std::vector<bool> done(lines.segments.size(), false);
    CurveMesh result;
    Index curves = 0;
    for (std::size_t s = 0; s < lines.segments.size(); ++s) {
      if (done[s]) continue;
      Index first = static_cast<Index>(s);
      for (Index n = arriving[at(lines.segments[s][0])]; n != kNone && n != static_cast<Index>(s);
           n = arriving[at(lines.segments[at(n)][0])]) {
        first = n;
      }
      // A loop comes back to s: it starts there.
      if (arriving[at(lines.segments[at(first)][0])] != kNone) first = static_cast<Index>(s);
      std::vector<Vec2> points{lines.points[at(lines.segments[at(first)][0])]};
      for (Index n = first; n != kNone && !done[at(n)]; n = leaving[at(lines.segments[at(n)][1])]) {
        done[at(n)] = true;
        points.push_back(lines.points[at(lines.segments[at(n)][1])]);
      }
      addLine(points, curves++, result);
    }
    return result;
  }

  void addLine(const std::vector<Vec2>& points, Index curve, CurveMesh& mesh) const {
    const bool loop = points.size() > 3 && points.front() == points.back();
    std::vector<bool> keep(points.size(), false);
    keep.front() = keep.back() = true;
    if (loop) {
      // Two anchors far apart: the first point and the one farthest from it.
      std::size_t far = 0;
      for (std::size_t i = 1; i + 1 < points.size(); ++i) {
        if ((points[i] - points[0]).norm() > (points[far] - points[0]).norm()) far = i;
      }
      keep[far] = true;
      thin(points, 0, far, keep);
      thin(points, far, points.size() - 1, keep);
    } else {
      thin(points, 0, points.size() - 1, keep);
    }
    const auto start = static_cast<Index>(mesh.points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!keep[i] || (loop && i + 1 == points.size())) continue;
      mesh.points.push_back(points[i]);
    }
    const auto end = static_cast<Index>(mesh.points.size());
    for (Index i = start; i + 1 < end; ++i) mesh.segments.push_back({i, i + 1});
    if (loop && end - start > 1) mesh.segments.push_back({end - 1, start});
    mesh.curveOf.resize(mesh.segments.size(), curve);
  }

  void thin(const std::vector<Vec2>& points, std::size_t from, std::size_t to,
            std::vector<bool>& keep) const {
    std::vector<std::pair<std::size_t, std::size_t>> ranges{{from, to}};
    while (!ranges.empty()) {
      const auto [a, b] = ranges.back();
      ranges.pop_back();
      const Vec2 along = points[b] - points[a];
      const double squared = along.squaredNorm();
      std::size_t worst = a;
      double most = kThinShare * tolerance_;
      for (std::size_t i = a + 1; i < b; ++i) {
        const Vec2 to = points[i] - points[a];
        const double t = squared > 0 ? std::clamp(to.dot(along) / squared, 0.0, 1.0) : 0;
        const double off = (to - t * along).norm();
        if (off <= most) continue;
        most = off;
        worst = i;
      }
      if (worst == a) continue;
      keep[worst] = true;
      ranges.push_back({a, worst});
      ranges.push_back({worst, b});
    }
  }

  [[nodiscard]] double deviation(const CurveMesh& lines) const {
    double worst = 0;
    for (const auto& [a, b] : lines.segments) {
      for (const double t : {0.0, 1.0 / 3, 0.5, 2.0 / 3}) {
        const Vec2 x = (1 - t) * lines.points[at(a)] + t * lines.points[at(b)];
        worst = std::max(worst, std::abs(curves_.foot(x).distance - std::abs(distance_)));
      }
    }
    return worst;
  }

  const CurveDistance& curves_;
  const OffsetCurveOptions& options_;
  double distance_;
  double tolerance_;
  NodeGrid grid_;
  std::vector<double> values_;
};

}  // namespace

Result<OffsetCurve> offsetCurve(const CurveDistance& curves, const OffsetCurveOptions& options,
                                const Progress& progress) {
  if (!std::isfinite(options.distance) || options.distance == 0) {
    return fail(ErrorCode::InvalidArgument, "The distance must be finite and not zero.",
                "distance");
  }
  if (options.tolerance && !(*options.tolerance > 0 && std::isfinite(*options.tolerance))) {
    return fail(ErrorCode::InvalidArgument, "The tolerance must be positive and finite.",
                "tolerance");
  }
  if (options.threads < 0) {
    return fail(ErrorCode::InvalidArgument, "The number of threads must not be negative.",
                "threads");
  }
  return CurveOffsetter(curves, options).run(progress);
}

}  // namespace phront
