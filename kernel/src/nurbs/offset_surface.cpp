// Control points of the offset of a surface, as for curves. Knots are sought for u on sampled lines
// of v and the other way round, as the error of a tensor product is about the sum of both.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "nurbs/edge_finder.h"
#include "nurbs/knot_search.h"
#include "nurbs/offset_rules.h"
#include "nurbs/surface_grid.h"

namespace phront {
namespace {

constexpr double kNarrowestOfFolded = 1e-3;  // span, of the domain
constexpr std::size_t kMostLines = 24;       // sampled across a surface
constexpr double kFarFromPole = 1e-3;   // |S_u x S_v| of the typical: below, normals are left alone
constexpr double kTightest = 0.6;       // of the tolerance, in one round
constexpr double kBySum = 2.5;          // times the tolerance: errors of u and v may add up to it
constexpr int kPerOriginalSpan = 2;     // samples inside each span of the original
constexpr double kWorthClimbing = 0.5;  // of the largest error sampled
constexpr double kFinestStep = 1e-3;    // of the distance of samples

/// As many of the parameters as there may be lines, ends included.
std::vector<double> linesAcross(const Knots& knots) {
  const std::vector<double> all = densely(knots, 2);
  if (all.size() <= kMostLines) return all;
  std::vector<double> some;
  for (std::size_t i = 0; i < kMostLines; ++i)
    some.push_back(all[i * (all.size() - 1) / (kMostLines - 1)]);
  return some;
}

/// Some in each span of an offset's knots, more of them the more an error can swing there, and at
/// both ends of the domain, where it swings fastest; and no span of the original's is passed over.
std::vector<double> samplesFor(const Knots& offset, const Knots& original) {
  std::vector<double> samples = densely(offset, std::max(offset.degree + 2, 2 * offset.degree));
  const double first = samples[1] - samples[0];
  const double last = samples[samples.size() - 1] - samples[samples.size() - 2];
  for (const double share : {0.25, 0.5, 0.75}) {
    samples.push_back(offset.first() + share * first);
    samples.push_back(offset.last() - share * last);
  }
  const std::vector<double> others = densely(original, kPerOriginalSpan);
  samples.insert(samples.end(), others.begin(), others.end());
  std::sort(samples.begin(), samples.end());
  samples.erase(std::unique(samples.begin(), samples.end()), samples.end());
  return samples;
}

Rows transposedPoints(const Rows& points, int stride) {
  const Eigen::Index columns = points.cols() / stride;
  Rows result(columns, points.rows() * stride);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    for (Eigen::Index j = 0; j < columns; ++j)
      result.block(j, i * stride, 1, stride) = points.block(i, j * stride, 1, stride);
  }
  return result;
}

class SurfaceOffsetter {
 public:
  SurfaceOffsetter(const NurbsSurface& surface, const NurbsOffsetOptions& options)
      : surface_(surface), options_(options), target_(surface, options.distance) {}

  Result<SurfaceOffset> run(const Progress& progress) {
    if (!target_.hasNormals()) {
      return fail(ErrorCode::InvalidArgument,
                  "The surface has no normal anywhere: it is a curve or a point.", "surface");
    }
    if (!target_.folds()) return fewestPoles(progress);
    // Swinging normals ask for ever narrower spans: not for long without smoothing.
    const auto tooMany = [](const Result<SurfaceOffset>& offset) {
      return !offset && offset.error().code == ErrorCode::ResourceLimit;
    };
    narrowest_ = kNarrowestOfFolded;
    Result<SurfaceOffset> offset = fewestPoles(progress);
    narrowest_ = KnotLimits().narrowest;
    for (const bool smooth : {true, false}) {
      if (!tooMany(offset)) break;
      target_.smoothFolds(smooth);
      offset = fewestPoles(progress);
    }
    return offset;
  }

 private:
  Result<SurfaceOffset> fewestPoles(const Progress& progress) const {
    std::optional<SurfaceOffset> best;
    const double exact = exactness();
    const auto keep = [&](std::optional<SurfaceOffset> other) {
      keepBetter(best, std::move(other), exact);
    };
    const auto keepGood = [&](std::optional<NurbsSurface> surface, PoleRule rule) {
      if (!surface) return;
      Judged tried = judged(std::move(*surface), rule);
      if (tried.offset.error <= options_.tolerance) keep(std::move(tried.offset));
    };
    keepGood(movedPoles(), PoleRule::Moved);
    keepGood(fitted(surface_.u, surface_.v), PoleRule::Fitted);
    const bool isExact = best && best->error <= exact;
    if (!best) {
      const Along refine = [&](bool u, const CurveBundle& lines, double tolerance) {
        return refined(u, lines, tolerance);
      };
      Result<std::optional<SurfaceOffset>> more =
          within(refine, options_.tolerance, progress.part(0, 0.3));
      if (!more) return tl::unexpected(more.error());
      keep(std::move(*more));
    }
    if (options_.knots == KnotRule::Fewest) {
      const Along reduce = [&](bool u, const CurveBundle& lines, double tolerance) {
        return fewest(u, lines, tolerance);
      };
      // An exact offset is left for an exact one only.
      const double tolerance = isExact ? std::min(options_.tolerance, exact) : options_.tolerance;
      Result<std::optional<SurfaceOffset>> fewer = within(reduce, tolerance, progress.part(0.3, 1));
      if (!fewer) return tl::unexpected(fewer.error());
      keep(std::move(*fewer));
    }
    if (!best) return tooManyPoles(options_);
    return std::move(*best);
  }

  using Along =
      std::function<std::optional<Knots>(bool u, const CurveBundle& lines, double tolerance)>;
  struct Location {
    double u = 0, v = 0;
  };
  struct Worst {
    double error = 0;
    Location at;
  };
  struct Judged {
    SurfaceOffset offset;
    Location worst;
  };

  [[nodiscard]] std::size_t most() const { return static_cast<std::size_t>(options_.maxPoles); }
  [[nodiscard]] KnotLimits limits(double tolerance, std::size_t maxPoles) const {
    return {.tolerance = tolerance, .maxPoles = maxPoles, .narrowest = narrowest_};
  }
  [[nodiscard]] const Knots& original(bool u) const { return u ? surface_.u : surface_.v; }

  [[nodiscard]] CurveBundle linesAlong(bool u, const std::vector<Location>& missed) const {
    std::vector<double> across = linesAcross(original(!u));
    for (const Location& at : missed) across.push_back(u ? at.v : at.u);
    std::sort(across.begin(), across.end());
    across.erase(std::unique(across.begin(), across.end()), across.end());
    const auto at = [this, u, across](std::span<const double> along) {
      return u ? target_.at(along, across)
               : transposedPoints(target_.at(across, along), target_.stride());
    };
    return {at, target_.stride()};
  }

  [[nodiscard]] std::optional<Knots> refined(bool u, const CurveBundle& lines,
                                             double tolerance) const {
    return refinedKnots(
        lines, original(u), [&](const Knots& knots) { return fittedPoles(lines, knots); },
        original(u).degree + 1, limits(tolerance, most()));
  }

  [[nodiscard]] std::optional<Knots> fewest(bool u, const CurveBundle& lines,
                                            double tolerance) const {
    std::optional<Knots> best;
    for (const int degree : degreesFor(original(u).degree)) {
      const std::size_t limit = best ? kPrunable * best->poleCount() : most();
      std::optional<Knots> other =
          fewestKnots(lines, original(u), degree, limits(tolerance, limit));
      if (other && (!best || other->poleCount() < best->poleCount())) best = std::move(other);
    }
    return best;
  }

  /// With knots for a share of the tolerance that leaves the whole within it. What the lines have
  /// missed becomes one of them.
  Result<std::optional<SurfaceOffset>> within(const Along& knotsAlong, double tolerance,
                                              const Progress& progress) const {
    const double wanted = tolerance;
    std::vector<Location> missed;
    for (int round = 0; round < kMostTightenings; ++round) {
      if (!progress.report(round / static_cast<double>(kMostTightenings)))
        return fail(ErrorCode::Cancelled, "Cancelled while a surface was offset.");
      const std::optional<Knots> u = knotsAlong(true, linesAlong(true, missed), tolerance);
      if (!u) break;
      const std::optional<Knots> v = knotsAlong(false, linesAlong(false, missed), tolerance);
      if (!v || u->poleCount() * v->poleCount() > most()) break;
      std::optional<NurbsSurface> surface = fitted(*u, *v);
      if (!surface) break;
      Judged found = judged(std::move(*surface), PoleRule::Fitted);
      if (found.offset.error <= wanted) return std::move(found.offset);
      missed.push_back(found.worst);
      const Vec3 place = evaluate(found.offset.surface, found.worst.u, found.worst.v).position;
      const double away = (place - target_.point(found.worst.u, found.worst.v)).norm();
      if (away <= kBySum * wanted)
        tolerance *= std::clamp(wanted / found.offset.error, kTightest, kTighter);
    }
    return std::optional<SurfaceOffset>();
  }

  [[nodiscard]] std::optional<NurbsSurface> fitted(const Knots& u, const Knots& v) const {
    const std::vector<double> us = samplesFor(u, surface_.u);
    const std::vector<double> vs = samplesFor(v, surface_.v);
    const int stride = target_.stride();
    const Rows inU = fitPoles(BasisRows(u, us), target_.at(us, vs));
    if (inU.size() == 0) return std::nullopt;
    const Rows poles = fitPoles(BasisRows(v, vs), transposedPoints(inU, stride));
    if (poles.size() == 0) return std::nullopt;
    NurbsSurface result{u, v, {}, {}};
    for (Eigen::Index j = 0; j < poles.rows(); ++j) {
      for (Eigen::Index i = 0; i < poles.cols(); i += stride) {
        const double weight = stride == 4 ? poles(j, i + 3) : 1;
        if (!(weight > 0)) return std::nullopt;
        result.poles.emplace_back(poles.block<1, 3>(j, i).transpose() / weight);
        if (stride == 4) result.weights.push_back(weight);
      }
    }
    return result;
  }

  [[nodiscard]] NurbsSurface movedPoles() const {
    NurbsSurface result = surface_;
    const std::vector<double> u = surface_.u.greville();
    const std::vector<double> v = surface_.v.greville();
    for (std::size_t n = 0; n < result.poles.size(); ++n)
      result.poles[n] += options_.distance * target_.normal(u[n % u.size()], v[n / u.size()]);
    return result;
  }

  [[nodiscard]] double exactness() const {
    double size = std::abs(options_.distance);
    for (const Vec3& pole : surface_.poles) size = std::max(size, pole.norm());
    return kExact * size;
  }

  [[nodiscard]] Judged judged(NurbsSurface surface, PoleRule rule) const {
    const Worst worst = largestError(surface);
    return {{std::move(surface), worst.error, rule}, worst.at};
  }

  /// Of dense samples, and of climbs from those that exceed their neighbours.
  [[nodiscard]] Worst largestError(const NurbsSurface& offset) const {
    const std::vector<double> us = samplesFor(offset.u, surface_.u);
    const std::vector<double> vs = samplesFor(offset.v, surface_.v);
    const Eigen::MatrixXd errors = errorsAt(offset, us, vs);
    Eigen::Index i = 0;
    Eigen::Index j = 0;
    const double most = errors.maxCoeff(&i, &j);
    Worst largest{most, {us[static_cast<std::size_t>(i)], vs[static_cast<std::size_t>(j)]}};
    if (!(most <= options_.tolerance)) return largest;
    for (j = 0; j < errors.cols(); ++j) {
      for (i = 0; i < errors.rows(); ++i) {
        if (errors(i, j) < kWorthClimbing * most || !exceedsNeighbours(errors, i, j)) continue;
        const Worst top =
            climbed(offset, us, vs, static_cast<std::size_t>(i), static_cast<std::size_t>(j));
        if (top.error > largest.error) largest = top;
      }
    }
    return largest;
  }

  [[nodiscard]] Eigen::MatrixXd errorsAt(const NurbsSurface& offset, const std::vector<double>& us,
                                         const std::vector<double>& vs) const {
    const Rows wanted = target_.at(us, vs);
    const SurfaceGrid from = gridOf(surface_, us, vs);
    const SurfaceGrid is = gridOf(offset, us, vs);
    const int stride = target_.stride();
    Eigen::MatrixXd errors(wanted.rows(), is.points.cols() / 3);
    for (Eigen::Index i = 0; i < errors.rows(); ++i) {
      for (Eigen::Index j = 0; j < errors.cols(); ++j) {
        const auto at = [i, j](const Rows& rows) {
          return Vec3(rows.block<1, 3>(i, 3 * j).transpose());
        };
        Vec3 p = wanted.block<1, 3>(i, j * stride).transpose();
        if (stride == 4) p /= wanted(i, j * stride + 3);
        const double error =
            errorOf({at(from.points), at(from.crosses), p}, at(is.points), at(is.crosses));
        errors(i, j) = std::isfinite(error) ? error : std::numeric_limits<double>::infinity();
      }
    }
    return errors;
  }

  /// A point of the original, S_u x S_v there, and P + d n.
  struct Wanted {
    Vec3 from, cross, to;
  };

  /// Of position; if it is to be reversible also of what the way back along the offset's own normal
  /// misses the original by, where the offset is far enough from folding to have that normal.
  [[nodiscard]] double errorOf(const Wanted& wanted, const Vec3& point, const Vec3& cross) const {
    const double there = (point - wanted.to).norm();
    if (!options_.reversible) return there;
    const Vec3 step = wanted.to - wanted.from;
    const double stretched = std::copysign(1, options_.distance) * cross.dot(step);
    const double area = wanted.cross.norm();
    if (!(area > kFarFromPole * target_.typicalCross()) ||
        !(stretched > kFarFromFold * area * step.norm()))
      return there;
    const Vec3 back = point - options_.distance * cross.normalized() - wanted.from;
    return std::max(there, back.norm());
  }

  static bool exceedsNeighbours(const Eigen::MatrixXd& errors, Eigen::Index i, Eigen::Index j) {
    const Eigen::Index top = std::max<Eigen::Index>(i - 1, 0);
    const Eigen::Index left = std::max<Eigen::Index>(j - 1, 0);
    const Eigen::Index rows = std::min(i + 2, errors.rows()) - top;
    const Eigen::Index columns = std::min(j + 2, errors.cols()) - left;
    return errors(i, j) >= errors.block(top, left, rows, columns).maxCoeff();
  }

  [[nodiscard]] Worst climbed(const NurbsSurface& offset, const std::vector<double>& us,
                              const std::vector<double>& vs, std::size_t i, std::size_t j) const {
    const auto error = [&](double u, double v) {
      const SurfacePoint from = evaluate(surface_, u, v);
      const SurfacePoint is = evaluate(offset, u, v);
      return errorOf({from.position, from.alongU.cross(from.alongV), target_.point(u, v)},
                     is.position, is.alongU.cross(is.alongV));
    };
    const auto range = [](const std::vector<double>& all, std::size_t k) {
      return std::array{all[k > 0 ? k - 1 : 0], all[std::min(k + 1, all.size() - 1)]};
    };
    const auto [u0, u1] = range(us, i);
    const auto [v0, v1] = range(vs, j);
    double u = us[i];
    double v = vs[j];
    double most = error(u, v);
    double share = 0.25;  // of the ranges: the next step
    for (int k = 0; k < kClimbs; ++k) {
      const double du = share * (u1 - u0);
      const double dv = share * (v1 - v0);
      bool up = false;
      for (const auto& [a, b] : {std::pair{du, 0.0}, {-du, 0.0}, {0.0, dv}, {0.0, -dv}}) {
        const double nextU = std::clamp(u + a, u0, u1);
        const double nextV = std::clamp(v + b, v0, v1);
        const double next = error(nextU, nextV);
        if (!(next > most)) continue;
        u = nextU;
        v = nextV;
        most = next;
        up = true;
      }
      if (!up) share /= 2;
      if (share < kFinestStep) break;
    }
    return {most, {u, v}};
  }

  const NurbsSurface& surface_;
  const NurbsOffsetOptions& options_;
  OffsetSurface target_;
  double narrowest_ = KnotLimits().narrowest;  // span, of the domain
};

}  // namespace

EdgeStrips edgeStrips(const NurbsSurface& surface, const NurbsOffsetOptions& options) {
  const OffsetSurface offset(surface, options.distance);
  const auto stripsAlong = [&](bool u, const std::vector<Interval>& without) {
    EdgeFinder finder(u ? surface.u : surface.v, options);
    for (const double s : linesAcross(u ? surface.v : surface.u)) {
      const bool cutOut = std::any_of(without.begin(), without.end(), [&](const Interval& strip) {
        return strip.low <= s && s <= strip.high;
      });
      if (cutOut) continue;
      finder.look([&](double t) { return u ? offset.normal(t, s) : offset.normal(s, t); },
                  [&](double t) { return evaluate(surface, u ? t : s, u ? s : t).position; });
    }
    return finder.strips();
  };
  // Inside an edge along u all lines along v may look broken, and the other way round.
  EdgeStrips first{stripsAlong(true, {}), {}};
  first.v = stripsAlong(false, first.u);
  if (first.u.empty()) return first;
  EdgeStrips second{{}, stripsAlong(false, {})};
  second.u = stripsAlong(true, second.v);
  return first.u.size() + first.v.size() <= second.u.size() + second.v.size() ? first : second;
}

Result<SurfaceOffset> offsetNurbs(const NurbsSurface& surface, const NurbsOffsetOptions& options,
                                  const Progress& progress) {
  if (auto ok = checkNurbs(surface); !ok) return tl::unexpected(ok.error());
  if (auto ok = checkOptions(options); !ok) return tl::unexpected(ok.error());
  const EdgeStrips edges = edgeStrips(surface, options);
  if (!edges.u.empty() || !edges.v.empty()) {
    return fail(ErrorCode::InvalidArgument,
                fmt::format("The surface has an edge at {} = {:g}; offset the pieces on both "
                            "sides of it.",
                            edges.u.empty() ? 'v' : 'u',
                            edges.u.empty() ? edges.v.front().low : edges.u.front().low),
                "surface");
  }
  return SurfaceOffsetter(surface, options).run(progress);
}

}  // namespace phront
