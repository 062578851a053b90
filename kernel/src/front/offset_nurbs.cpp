// Control points of an offset.
//
// The points P + d n that belong to the poles' parameters (Greville's, one per pole) are moved
// exactly; the poles follow by one of two rules: by the same step (Coquillart, "Computing offsets
// of B-spline curves", 1987), or so that the offset passes through the moved points. Both keep
// degree, weights and parameter. Interpolation is done on numerator and denominator apart, so that
// circles, and whatever else has its offset in the same space, come out exact. Where the offset
// misses P + d n by more than the tolerance knots are added: on a surface for u along sampled lines
// of v and the other way round, as the error of a tensor product is about the sum of both.
#include "phront/offset_nurbs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "front/spline_fit.h"

namespace phront {
namespace {

constexpr int kMostRounds = 40;
constexpr std::size_t kMostAlong = 1000;    // poles along a direction: the solver is dense
constexpr double kNarrowest = 1e-8;         // span of the domain: where cutting does not help
constexpr int kMostPieces = 4;              // of a span in one round
constexpr double kShareOfDirection = 0.45;  // of the tolerance, for u and v each
constexpr double kTighter = 0.7;            // when both together miss the tolerance
constexpr std::size_t kMostLines = 24;      // sampled across a surface
constexpr double kCorner = 1e-6;            // rad between normals on both sides of a knot
constexpr double kBesideKnot = 1e-9;        // of a span
constexpr double kDegenerate = 1e-8;        // of the typical |S_u x S_v|
constexpr double kIntoDomain = 1e-6;  // of the domain: from where a degenerate normal is taken
constexpr int kClimbs = 40;           // steps to a largest error

using Row = Eigen::RowVectorXd;
/// Points with their weights along a parameter: (w x, w y, w z, w) for each of some lines.
using Lines = std::function<Row(double)>;

int samplesPerSpan(const Knots& knots) { return 2 * knots.degree + 2; }

Eigen::MatrixXd at(const Lines& lines, std::span<const double> parameters) {
  Eigen::MatrixXd values;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Row row = lines(parameters[i]);
    if (i == 0) values.resize(static_cast<Eigen::Index>(parameters.size()), row.size());
    values.row(static_cast<Eigen::Index>(i)) = row;
  }
  return values;
}

/// Largest distance between the points of two rows.
double apart(const Row& a, const Row& b) {
  double most = 0;
  for (Eigen::Index k = 0; k + 3 < a.size(); k += 4) {
    const Vec3 gap =
        a.segment<3>(k).transpose() / a[k + 3] - b.segment<3>(k).transpose() / b[k + 3];
    if (!gap.allFinite()) return std::numeric_limits<double>::infinity();
    most = std::max(most, gap.norm());
  }
  return most;
}

std::size_t index(Eigen::Index i) { return static_cast<std::size_t>(i); }

/// Largest error in each span, of poles against what they should give.
std::vector<double> spanErrors(const Knots& knots, const Eigen::MatrixXd& poles,
                               const Lines& target) {
  const int inside = samplesPerSpan(knots);
  const std::vector<double> parameters = densely(knots, inside);
  const Eigen::MatrixXd fitted = basisMatrix(knots, parameters) * poles;
  std::vector<double> errors(knots.distinct().size() - 1, 0);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double error = apart(fitted.row(static_cast<Eigen::Index>(i)), target(parameters[i]));
    // A knot belongs to both spans.
    const std::size_t span = i / (static_cast<std::size_t>(inside) + 1);
    const bool onKnot = i % (static_cast<std::size_t>(inside) + 1) == 0;
    if (span < errors.size()) errors[span] = std::max(errors[span], error);
    if (onKnot && span > 0) errors[span - 1] = std::max(errors[span - 1], error);
  }
  return errors;
}

/// Cuts spans whose error is too large into as many pieces as their order of convergence asks for.
Knots refined(const Knots& knots, const std::vector<double>& errors, double tolerance,
              int orderOfError) {
  const std::vector<double> ends = knots.distinct();
  std::vector<double> added;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    if (errors[k] <= tolerance) continue;
    const double wanted = std::ceil(std::pow(errors[k] / tolerance, 1.0 / orderOfError));
    const int pieces = static_cast<int>(std::clamp(wanted, 2.0, double(kMostPieces)));
    for (int i = 1; i < pieces; ++i)
      added.push_back(ends[k] + (ends[k + 1] - ends[k]) * i / pieces);
  }
  return withKnots(knots, added);
}

/// Width of the narrowest span that is to be cut.
double narrowest(const Knots& knots, const std::vector<double>& errors, double tolerance) {
  const std::vector<double> ends = knots.distinct();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < errors.size(); ++k) {
    if (errors[k] > tolerance) least = std::min(least, ends[k + 1] - ends[k]);
  }
  return least;
}

using PolesOf = std::function<Eigen::MatrixXd(const Knots&)>;

/// Knots for which the poles are right within the tolerance; none when there would be too many.
std::optional<Knots> knotsFor(Knots knots, const PolesOf& polesOf, const Lines& target,
                              double tolerance, int orderOfError, std::size_t maxPoles) {
  const std::size_t most = std::min(maxPoles, kMostAlong);
  for (int round = 0; round < kMostRounds && knots.poleCount() <= most; ++round) {
    const std::vector<double> errors = spanErrors(knots, polesOf(knots), target);
    if (*std::max_element(errors.begin(), errors.end()) <= tolerance) return knots;
    if (narrowest(knots, errors, tolerance) < kNarrowest * (knots.last() - knots.first())) break;
    knots = refined(knots, errors, tolerance, orderOfError);
  }
  return std::nullopt;
}

Eigen::MatrixXd interpolated(const Knots& knots, const Lines& lines) {
  const SplineInterpolation interpolation(knots);
  return interpolation.poles(at(lines, interpolation.parameters()));
}

/// Climbs from a parameter to a largest value of f within [low, high].
template <class F>
double largestNear(const F& f, double t, double step, double low, double high) {
  double most = f(t);
  for (int i = 0; i < kClimbs; ++i) {
    const double before = std::max(low, t - step);
    const double after = std::min(high, t + step);
    const double a = f(before);
    const double b = f(after);
    if (a > most || b > most) {
      t = a > b ? before : after;
      most = std::max(a, b);
    } else {
      step /= 2;
    }
  }
  return most;
}

Result<void> checkOptions(const NurbsOffsetOptions& options) {
  if (!std::isfinite(options.distance)) {
    return fail(ErrorCode::InvalidArgument, "The distance must be a number.", "distance");
  }
  if (!(options.tolerance > 0) || !std::isfinite(options.tolerance)) {
    return fail(ErrorCode::InvalidArgument, "The tolerance must be positive.", "tolerance");
  }
  return {};
}

tl::unexpected<Error> tooMany(const NurbsOffsetOptions& options) {
  return fail(ErrorCode::ResourceLimit,
              fmt::format("The tolerance {:g} asks for more than {} poles, or {} along one "
                          "direction; use a coarser one.",
                          options.tolerance, options.maxPoles, kMostAlong),
              "tolerance");
}

Row homogeneous(const Vec3& point, double weight) {
  Row row(4);
  row << weight * point.transpose(), weight;
  return row;
}

bool rational(const Eigen::MatrixXd& weights) {
  return (weights.array() - weights(0)).abs().maxCoeff() > 1e-14 * weights(0);
}

// ---- curves

class CurveOffsetter {
 public:
  CurveOffsetter(const NurbsCurve& curve, const CurveNormal& normal,
                 const NurbsOffsetOptions& options)
      : curve_(curve), normal_(normal), options_(options) {}

  Result<CurveOffset> run() const {
    if (auto ok = checkNormals(); !ok) return tl::unexpected(ok.error());
    const Lines moved = [this](double t) {
      const CurvePoint p = evaluate(curve_, t);
      return homogeneous(p.position + options_.distance * normal_(t), p.weight);
    };
    const Lines original = [this](double t) {
      const CurvePoint p = evaluate(curve_, t);
      return homogeneous(p.position, p.weight);
    };
    const PolesOf interpolate = [&](const Knots& knots) { return interpolated(knots, moved); };
    const PolesOf move = [&](const Knots& knots) {
      Eigen::MatrixXd poles = interpolated(knots, original);
      const std::vector<double> parameters = knots.greville();
      for (Eigen::Index i = 0; i < poles.rows(); ++i) {
        poles.row(i).head<3>() +=
            poles(i, 3) * options_.distance * normal_(parameters[index(i)]).transpose();
      }
      return poles;
    };
    const auto most = static_cast<std::size_t>(options_.maxPoles);
    // Moved poles win ties: theirs is the simpler rule.
    std::optional<CurveOffset> best = bestOf(interpolate, moved, PoleRule::Interpolated, most);
    const std::size_t limit = best ? best->curve.poles.size() : most;
    if (auto other = bestOf(move, moved, PoleRule::Moved, limit)) best = std::move(other);
    if (!best) return tooMany(options_);
    return std::move(*best);
  }

 private:
  Result<void> checkNormals() const {
    std::vector<double> parameters = densely(curve_.knots, samplesPerSpan(curve_.knots));
    for (const double t : curve_.knots.greville()) parameters.push_back(t);
    for (const double t : parameters) {
      if (!(std::abs(normal_(t).norm() - 1) <= kCorner)) {
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("The curve has no normal at parameter {:g}.", t), "curve");
      }
    }
    const std::vector<double> ends = curve_.knots.distinct();
    for (std::size_t k = 1; k + 1 < ends.size(); ++k) {
      const Vec3 before = normal_(ends[k] - kBesideKnot * (ends[k] - ends[k - 1]));
      const Vec3 after = normal_(ends[k] + kBesideKnot * (ends[k + 1] - ends[k]));
      if (!((before - after).norm() <= kCorner)) {
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("The curve has a corner at parameter {:g}; offset the pieces on "
                                "both sides of it.",
                                ends[k]),
                    "curve");
      }
    }
    return {};
  }

  std::optional<CurveOffset> bestOf(const PolesOf& polesOf, const Lines& target, PoleRule rule,
                                    std::size_t maxPoles) const {
    const int order = rule == PoleRule::Moved ? 2 : curve_.knots.degree + 1;
    double tolerance = options_.tolerance;
    for (int round = 0; round < kMostRounds; ++round, tolerance *= kTighter) {
      const auto knots = knotsFor(curve_.knots, polesOf, target, tolerance, order, maxPoles);
      if (!knots) return std::nullopt;
      CurveOffset result{curveOf(*knots, polesOf(*knots)), 0, rule};
      result.error = largestError(result.curve, target);
      if (result.error <= options_.tolerance) return result;
    }
    return std::nullopt;
  }

  static NurbsCurve curveOf(const Knots& knots, const Eigen::MatrixXd& poles) {
    NurbsCurve curve{knots, {}, {}};
    for (Eigen::Index i = 0; i < poles.rows(); ++i)
      curve.poles.emplace_back(poles.row(i).head<3>().transpose() / poles(i, 3));
    if (rational(poles.col(3))) curve.weights.assign(poles.col(3).begin(), poles.col(3).end());
    return curve;
  }

  static double largestError(const NurbsCurve& curve, const Lines& target) {
    const auto error = [&](double t) {
      return (evaluate(curve, t).position - target(t).head<3>().transpose() / target(t)[3]).norm();
    };
    const std::vector<double> samples = densely(curve.knots, samplesPerSpan(curve.knots));
    double most = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double low = samples[i > 0 ? i - 1 : 0];
      const double high = samples[std::min(i + 1, samples.size() - 1)];
      most = std::max(most, largestNear(error, samples[i], (high - low) / 4, low, high));
    }
    return most;
  }

  const NurbsCurve& curve_;
  const CurveNormal& normal_;
  const NurbsOffsetOptions& options_;
};

// ---- surfaces

class SurfaceOffsetter {
 public:
  SurfaceOffsetter(const NurbsSurface& surface, const NurbsOffsetOptions& options)
      : surface_(surface), options_(options) {
    for (const double u : densely(Knots{1, {surface.u.first(), surface.u.last()}}, 5)) {
      for (const double v : densely(Knots{1, {surface.v.first(), surface.v.last()}}, 5)) {
        const SurfacePoint p = evaluate(surface_, u, v);
        typical_ = std::max(typical_, p.alongU.cross(p.alongV).norm());
      }
    }
  }

  Result<SurfaceOffset> run(const Progress& progress) const {
    if (!(typical_ > 0)) {
      return fail(ErrorCode::InvalidArgument,
                  "The surface has no normal anywhere: it is a curve or a point.", "surface");
    }
    for (const bool u : {true, false}) {
      if (auto ok = checkCorners(u); !ok) return tl::unexpected(ok.error());
    }
    const auto most = static_cast<std::size_t>(options_.maxPoles);
    std::optional<SurfaceOffset> best;
    double share = kShareOfDirection;
    for (int round = 0; round < kMostRounds && !best; ++round, share *= kTighter) {
      if (!progress.report(round / static_cast<double>(kMostRounds))) {
        return fail(ErrorCode::Cancelled, "Cancelled while a surface was offset.");
      }
      const auto u = knotsAlong(true, share * options_.tolerance, most);
      const auto v = u ? knotsAlong(false, share * options_.tolerance, most) : std::nullopt;
      if (!v || u->poleCount() * v->poleCount() > most) return tooMany(options_);
      SurfaceOffset tried{surfaceOf(*u, *v), 0, PoleRule::Interpolated};
      tried.error = largestError(tried.surface);
      if (tried.error <= options_.tolerance) best = std::move(tried);
    }
    if (!best) return tooMany(options_);
    SurfaceOffset moved{movedPoles(), 0, PoleRule::Moved};
    moved.error = largestError(moved.surface);
    if (moved.error <= options_.tolerance) return moved;
    return std::move(*best);
  }

 private:
  Vec3 normal(double u, double v) const {
    const auto cross = [&](double a, double b) {
      const SurfacePoint p = evaluate(surface_, a, b);
      return Vec3(p.alongU.cross(p.alongV));
    };
    Vec3 n = cross(u, v);
    if (n.norm() > kDegenerate * typical_) return n.normalized();
    const auto inward = [](const Knots& knots, double t) {
      const double middle = 0.5 * (knots.first() + knots.last());
      return t + std::copysign(kIntoDomain * (knots.last() - knots.first()), middle - t);
    };
    const double a = inward(surface_.u, u);
    const double b = inward(surface_.v, v);
    for (const Vec3& other : {cross(u, b), cross(a, v), cross(a, b)}) {
      if (other.norm() > n.norm()) n = other;
    }
    const double length = n.norm();
    return length > 0 ? Vec3(n / length) : Vec3::Zero();
  }

  Row moved(double u, double v) const {
    const SurfacePoint p = evaluate(surface_, u, v);
    return homogeneous(p.position + options_.distance * normal(u, v), p.weight);
  }

  /// Across the inner knots along u or v.
  [[nodiscard]] Result<void> checkCorners(bool u) const {
    const std::vector<double> ends = (u ? surface_.u : surface_.v).distinct();
    const std::vector<double> across = linesAcross(u ? surface_.v : surface_.u);
    const auto normalAt = [&](double t, double s) { return u ? normal(t, s) : normal(s, t); };
    for (std::size_t k = 1; k + 1 < ends.size(); ++k) {
      for (const double s : across) {
        const Vec3 before = normalAt(ends[k] - kBesideKnot * (ends[k] - ends[k - 1]), s);
        const Vec3 after = normalAt(ends[k] + kBesideKnot * (ends[k + 1] - ends[k]), s);
        if ((before - after).norm() <= kCorner) continue;
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("The surface has an edge at {} = {:g}; offset the pieces on both "
                                "sides of it.",
                                u ? 'u' : 'v', ends[k]),
                    "surface");
      }
    }
    return {};
  }

  static std::vector<double> linesAcross(const Knots& knots) {
    const std::vector<double> all = densely(knots, 1);
    if (all.size() <= kMostLines) return all;
    std::vector<double> some;
    for (std::size_t i = 0; i < kMostLines; ++i)
      some.push_back(all[i * (all.size() - 1) / (kMostLines - 1)]);
    return some;
  }

  std::optional<Knots> knotsAlong(bool u, double tolerance, std::size_t maxPoles) const {
    const Knots& along = u ? surface_.u : surface_.v;
    const std::vector<double> across = linesAcross(u ? surface_.v : surface_.u);
    const Lines target = [&](double t) {
      Row row(4 * static_cast<Eigen::Index>(across.size()));
      for (std::size_t k = 0; k < across.size(); ++k) {
        row.segment<4>(4 * static_cast<Eigen::Index>(k)) =
            u ? moved(t, across[k]) : moved(across[k], t);
      }
      return row;
    };
    const PolesOf interpolate = [&](const Knots& knots) { return interpolated(knots, target); };
    return knotsFor(along, interpolate, target, tolerance, along.degree + 1, maxPoles);
  }

  NurbsSurface surfaceOf(const Knots& u, const Knots& v) const {
    const SplineInterpolation inU(u);
    const SplineInterpolation inV(v);
    const auto rows = static_cast<Eigen::Index>(u.poleCount());
    const auto columns = static_cast<Eigen::Index>(v.poleCount());
    std::array<Eigen::MatrixXd, 4> poles;
    poles.fill(Eigen::MatrixXd(rows, columns));
    for (Eigen::Index i = 0; i < rows; ++i) {
      for (Eigen::Index j = 0; j < columns; ++j) {
        const Row point = moved(inU.parameters()[index(i)], inV.parameters()[index(j)]);
        for (std::size_t k = 0; k < 4; ++k) poles[k](i, j) = point[static_cast<Eigen::Index>(k)];
      }
    }
    for (Eigen::MatrixXd& values : poles)
      values = inV.poles(inU.poles(values).transpose()).transpose();
    NurbsSurface result{u, v, {}, {}};
    const bool weighted = rational(poles[3].reshaped());
    for (Eigen::Index j = 0; j < columns; ++j) {
      for (Eigen::Index i = 0; i < rows; ++i) {
        const double weight = poles[3](i, j);
        result.poles.emplace_back(poles[0](i, j) / weight, poles[1](i, j) / weight,
                                  poles[2](i, j) / weight);
        if (weighted) result.weights.push_back(weight);
      }
    }
    return result;
  }

  NurbsSurface movedPoles() const {
    NurbsSurface result = surface_;
    const std::vector<double> u = surface_.u.greville();
    const std::vector<double> v = surface_.v.greville();
    for (std::size_t n = 0; n < result.poles.size(); ++n)
      result.poles[n] += options_.distance * normal(u[n % u.size()], v[n / u.size()]);
    return result;
  }

  double largestError(const NurbsSurface& offset) const {
    const auto error = [&](double u, double v) {
      const Row wanted = moved(u, v);
      return (evaluate(offset, u, v).position - wanted.head<3>().transpose() / wanted[3]).norm();
    };
    const std::vector<double> u = densely(offset.u, offset.u.degree + 1);
    const std::vector<double> v = densely(offset.v, offset.v.degree + 1);
    double most = 0;
    std::array<std::size_t, 2> worst{};
    for (std::size_t j = 0; j < v.size(); ++j) {
      for (std::size_t i = 0; i < u.size(); ++i) {
        const double here = error(u[i], v[j]);
        if (!(here > most)) continue;
        most = here;
        worst = {i, j};
      }
    }
    const auto range = [](const std::vector<double>& all, std::size_t i) {
      return std::array{all[i > 0 ? i - 1 : 0], all[std::min(i + 1, all.size() - 1)]};
    };
    const auto inU = range(u, worst[0]);
    const auto inV = range(v, worst[1]);
    return std::max(largestNear([&](double t) { return error(t, v[worst[1]]); }, u[worst[0]],
                                (inU[1] - inU[0]) / 4, inU[0], inU[1]),
                    largestNear([&](double t) { return error(u[worst[0]], t); }, v[worst[1]],
                                (inV[1] - inV[0]) / 4, inV[0], inV[1]));
  }

  const NurbsSurface& surface_;
  const NurbsOffsetOptions& options_;
  double typical_ = 0;  ///< |S_u x S_v|
};

}  // namespace

CurveNormal normalInPlane(const NurbsCurve& curve, const Vec3& planeNormal) {
  return [curve, planeNormal](double t) {
    return Vec3(evaluate(curve, t).tangent.cross(planeNormal).normalized());
  };
}

Result<CurveOffset> offsetNurbs(const NurbsCurve& curve, const CurveNormal& normal,
                                const NurbsOffsetOptions& options) {
  if (auto ok = checkNurbs(curve); !ok) return tl::unexpected(ok.error());
  if (auto ok = checkOptions(options); !ok) return tl::unexpected(ok.error());
  return CurveOffsetter(curve, normal, options).run();
}

Result<SurfaceOffset> offsetNurbs(const NurbsSurface& surface, const NurbsOffsetOptions& options,
                                  const Progress& progress) {
  if (auto ok = checkNurbs(surface); !ok) return tl::unexpected(ok.error());
  if (auto ok = checkOptions(options); !ok) return tl::unexpected(ok.error());
  return SurfaceOffsetter(surface, options).run(progress);
}

}  // namespace phront
