// Control points of the offset of a curve.
//
// The points P + d n that belong to the poles' parameters (Greville's, one per pole) are moved
// exactly; the poles follow by one of two rules: by the same step (Coquillart, "Computing offsets
// of B-spline curves", 1987), or so that the offset comes nearest to many moved points. The fit is
// done on numerator and denominator apart, so that circles, and whatever else has its offset in the
// same space, come out exact.
#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "nurbs/edge_finder.h"
#include "nurbs/knot_search.h"
#include "nurbs/offset_rules.h"
#include "nurbs/surface_grid.h"

namespace phront {
namespace {

constexpr int kSamples = 8;           // per span, in search of missing normals
constexpr double kUnitLength = 1e-6;  // most that a normal's length may be off

/// A curve with a weight at each parameter.
struct WeightedPoint {
  Vec3 position;
  double weight = 1;
};
using WeightedCurve = std::function<WeightedPoint(double)>;

/// Error of the way back from a point of the offset, if that is to be bounded too.
using WayBack = std::function<double(double t, const CurvePoint& offset)>;

CurveBundle bundleOf(const WeightedCurve& curve, int stride) {
  const auto at = [curve, stride](std::span<const double> parameters) {
    Rows rows(static_cast<Eigen::Index>(parameters.size()), stride);
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const WeightedPoint p = curve(parameters[i]);
      const auto row = static_cast<Eigen::Index>(i);
      rows.block<1, 3>(row, 0) = (stride == 4 ? p.weight : 1) * p.position.transpose();
      if (stride == 4) rows(row, 3) = p.weight;
    }
    return rows;
  };
  return {at, stride};
}

NurbsCurve curveOf(const Knots& knots, const Rows& poles) {
  NurbsCurve curve{knots, {}, {}};
  const bool weighted = poles.cols() == 4;
  for (Eigen::Index i = 0; i < poles.rows(); ++i) {
    const double weight = weighted ? poles(i, 3) : 1;
    curve.poles.emplace_back(poles.row(i).head<3>().transpose() / weight);
    if (weighted) curve.weights.push_back(weight);
  }
  return curve;
}

/// Finds knots and poles for points that a curve is to pass within a tolerance.
class CurveFit {
 public:
  CurveFit(const WeightedCurve& target, int stride, const Knots& original,
           const NurbsOffsetOptions& options, WayBack wayBack = {})
      : target_(target),
        wayBack_(std::move(wayBack)),
        bundle_(bundleOf(target, stride)),
        original_(original),
        options_(options),
        most_(static_cast<std::size_t>(options.maxPoles)) {}

  /// With the original's knots, refined, up to so many poles.
  std::optional<CurveOffset> refined(const PolesOf& polesOf, PoleRule rule,
                                     std::size_t most) const {
    const int order = rule == PoleRule::Moved ? 2 : original_.degree + 1;
    return within(
        [&](double tolerance) {
          return refinedKnots(bundle_, original_, polesOf, order, {tolerance, most});
        },
        polesOf, rule);
  }
  std::optional<CurveOffset> refined() const { return refined(fitted(), PoleRule::Fitted, most_); }

  /// Begins with at most so many poles.
  std::optional<CurveOffset> fewest(int degree, std::size_t most) const {
    return within(
        [&](double tolerance) {
          return fewestKnots(bundle_, original_, degree, {tolerance, std::min(most, most_)});
        },
        fitted(), PoleRule::Fitted);
  }

 private:
  [[nodiscard]] PolesOf fitted() const {
    return [this](const Knots& knots) { return fittedPoles(bundle_, knots); };
  }

  template <class KnotsFor>
  std::optional<CurveOffset> within(const KnotsFor& knotsFor, const PolesOf& polesOf,
                                    PoleRule rule) const {
    double tolerance = options_.tolerance;
    for (int round = 0; round < kMostTightenings; ++round, tolerance *= kTighter) {
      const std::optional<Knots> knots = knotsFor(tolerance);
      if (!knots) return std::nullopt;
      CurveOffset result{curveOf(*knots, polesOf(*knots)), 0, rule};
      result.error = largestError(result.curve);
      if (result.error <= options_.tolerance) return result;
    }
    return std::nullopt;
  }

  [[nodiscard]] double largestError(const NurbsCurve& curve) const {
    const auto error = [&](double t) {
      const CurvePoint p = evaluate(curve, t);
      const double there = (p.position - target_(t).position).norm();
      return wayBack_ ? std::max(there, wayBack_(t, p)) : there;
    };
    const std::vector<double> samples = densely(curve.knots, 2 * curve.knots.degree + 2);
    double most = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double low = samples[i > 0 ? i - 1 : 0];
      const double high = samples[std::min(i + 1, samples.size() - 1)];
      most = std::max(most, largestNear(error, samples[i], (high - low) / 4, low, high));
    }
    return most;
  }

  const WeightedCurve& target_;
  WayBack wayBack_;
  CurveBundle bundle_;
  const Knots& original_;
  const NurbsOffsetOptions& options_;
  std::size_t most_;
};

double exactness(const WeightedCurve& target, const Knots& original,
                 const NurbsOffsetOptions& options) {
  double size = std::abs(options.distance);
  for (const double t : densely(original, 1)) size = std::max(size, target(t).position.norm());
  return kExact * size;
}

/// Of `best` and, if they may, other knots. An exact offset is left for an exact one only.
Result<CurveOffset> fewestOf(std::optional<CurveOffset> best, const WeightedCurve& target,
                             int stride, const Knots& original, NurbsOffsetOptions options,
                             const WayBack& wayBack = {}) {
  const double exact = exactness(target, original, options);
  if (options.knots == KnotRule::Fewest) {
    if (best && best->error <= exact) options.tolerance = std::min(options.tolerance, exact);
    const CurveFit fit(target, stride, original, options, wayBack);
    for (const int degree : degreesFor(original.degree)) {
      const std::size_t most =
          best ? kPrunable * best->curve.poles.size() : static_cast<std::size_t>(options.maxPoles);
      keepBetter(best, fit.fewest(degree, most), exact);
    }
  }
  if (!best) return tooManyPoles(options);
  return std::move(*best);
}

Result<void> checkNormals(const NurbsCurve& curve, const CurveNormal& normal) {
  std::vector<double> parameters = densely(curve.knots, kSamples);
  for (const double t : curve.knots.greville()) parameters.push_back(t);
  for (const double t : parameters) {
    if (std::abs(normal(t).norm() - 1) <= kUnitLength) continue;
    return fail(ErrorCode::InvalidArgument,
                fmt::format("The curve has no normal at parameter {:g}.", t), "curve");
  }
  return {};
}

}  // namespace

std::vector<Interval> cornerStrips(const NurbsCurve& curve, const CurveNormal& normal,
                                   const NurbsOffsetOptions& options) {
  EdgeFinder finder(curve.knots, options);
  finder.look(normal, [&](double t) { return evaluate(curve, t).position; });
  return finder.strips();
}

CurveNormal normalInPlane(const NurbsCurve& curve, const Vec3& planeNormal) {
  return [curve, planeNormal](double t) {
    return Vec3(evaluate(curve, t).tangent.cross(planeNormal).normalized());
  };
}

Result<CurveOffset> offsetNurbs(const NurbsCurve& curve, const CurveNormal& normal,
                                const NurbsOffsetOptions& options) {
  if (auto ok = checkNurbs(curve); !ok) return tl::unexpected(ok.error());
  if (auto ok = checkOptions(options); !ok) return tl::unexpected(ok.error());
  if (auto ok = checkNormals(curve, normal); !ok) return tl::unexpected(ok.error());
  if (const auto corners = cornerStrips(curve, normal, options); !corners.empty()) {
    return fail(ErrorCode::InvalidArgument,
                fmt::format("The curve has a corner at parameter {:g}; offset the pieces on both "
                            "sides of it.",
                            corners.front().low),
                "curve");
  }
  const int stride = isRational(curve.weights) ? 4 : 3;
  const WeightedCurve moved = [&](double t) {
    const CurvePoint p = evaluate(curve, t);
    return WeightedPoint{p.position + options.distance * normal(t), p.weight};
  };
  const CurveBundle original = bundleOf(
      [&](double t) {
        const CurvePoint p = evaluate(curve, t);
        return WeightedPoint{p.position, p.weight};
      },
      stride);
  WayBack wayBack;
  if (options.reversible) {
    wayBack = [&](double t, const CurvePoint& offset) {
      const CurvePoint from = evaluate(curve, t);
      // Beyond the radius of curvature there is no way back.
      if (offset.tangent.dot(from.tangent) < kFarFromFold * from.tangent.squaredNorm()) return 0.0;
      const Vec3 along = offset.tangent.normalized();
      const Vec3 n = normal(t);
      const Vec3 across = (n - n.dot(along) * along).normalized();
      return (offset.position - options.distance * across - from.position).norm();
    };
  }
  const PolesOf move = [&](const Knots& knots) {
    Rows poles = fittedPoles(original, knots);
    const std::vector<double> parameters = knots.greville();
    for (Eigen::Index i = 0; i < poles.rows(); ++i) {
      poles.row(i).head<3>() += (stride == 4 ? poles(i, 3) : 1) * options.distance *
                                normal(parameters[static_cast<std::size_t>(i)]).transpose();
    }
    return poles;
  };
  const CurveFit fit(moved, stride, curve.knots, options, wayBack);
  std::optional<CurveOffset> best = fit.refined();
  const std::size_t most =
      best ? best->curve.poles.size() : static_cast<std::size_t>(options.maxPoles);
  std::optional<CurveOffset> simpler = fit.refined(move, PoleRule::Moved, most);
  // The simpler rule wins when both are exact.
  keepBetter(simpler, std::move(best), exactness(moved, curve.knots, options));
  best = std::move(simpler);
  return fewestOf(std::move(best), moved, stride, curve.knots, options, wayBack);
}

Result<CurveOffset> fitCurve(const std::function<Vec3(double t)>& point, const Knots& knots,
                             const NurbsOffsetOptions& options) {
  if (auto ok = checkKnots(knots); !ok) return tl::unexpected(ok.error());
  if (auto ok = checkOptions(options); !ok) return tl::unexpected(ok.error());
  const WeightedCurve target = [&](double t) { return WeightedPoint{point(t), 1}; };
  const CurveFit fit(target, 3, knots, options);
  return fewestOf(fit.refined(), target, 3, knots, options);
}

}  // namespace phront
