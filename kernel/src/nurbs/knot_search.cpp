// Down from many knots: those whose removal changes the fitted curves least go, as many at a time
// as the tolerance allows after a new fit (after Lyche & Moerken, "Knot removal for parametric
// B-spline curves and surfaces", 1987; the change is the one of Tiller, "Knot-removal algorithms
// for NURBS curves and surfaces", 1992).
#include "nurbs/knot_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace phront {
namespace {

constexpr int kMostRounds = 40;
constexpr int kMostPieces = 4;  // of a span in one round
constexpr int kSingles = 6;     // knots tried alone when no two of them can go
constexpr double kInfinite = std::numeric_limits<double>::infinity();

Eigen::Index at(std::size_t i) { return static_cast<Eigen::Index>(i); }

int samplesPerSpan(const Knots& knots) { return 2 * knots.degree + 2; }

/// Largest error in each span of `knots`, for samples as densely() gives them.
std::vector<double> spanErrors(const Knots& knots, const Rows& fitted, const Rows& wanted,
                               int stride) {
  const std::size_t pitch = static_cast<std::size_t>(samplesPerSpan(knots)) + 1;
  std::vector<double> errors(knots.distinct().size() - 1, 0);
  for (Eigen::Index i = 0; i < wanted.rows(); ++i) {
    const double error = apart(fitted.row(i), wanted.row(i), stride);
    // A knot belongs to both spans.
    const std::size_t span = static_cast<std::size_t>(i) / pitch;
    const bool onKnot = static_cast<std::size_t>(i) % pitch == 0;
    if (span < errors.size()) errors[span] = std::max(errors[span], error);
    if (onKnot && span > 0) errors[span - 1] = std::max(errors[span - 1], error);
  }
  return errors;
}

/// Cuts spans whose error is too large into as many pieces as their order of convergence asks for.
Knots cut(const Knots& knots, const std::vector<double>& errors, double tolerance, int order) {
  const std::vector<double> ends = knots.distinct();
  Knots result = knots;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    if (errors[k] <= tolerance) continue;
    const double wanted = std::ceil(std::pow(errors[k] / tolerance, 1.0 / order));
    const int pieces = static_cast<int>(std::clamp(wanted, 2.0, double(kMostPieces)));
    for (int i = 1; i < pieces; ++i)
      result.flat.push_back(ends[k] + (ends[k + 1] - ends[k]) * i / pieces);
  }
  std::sort(result.flat.begin(), result.flat.end());
  return result;
}

/// Width of the narrowest span that is to be cut.
double narrowest(const Knots& knots, const std::vector<double>& errors, double tolerance) {
  const std::vector<double> ends = knots.distinct();
  double least = kInfinite;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    if (errors[k] > tolerance) least = std::min(least, ends[k + 1] - ends[k]);
  }
  return least;
}

/// Largest distance of points of two rows, weights left out.
double change(const Eigen::RowVectorXd& difference, int stride) {
  double most = 0;
  for (Eigen::Index k = 0; k < difference.size(); k += stride)
    most = std::max(most, difference.segment<3>(k).norm());
  return most;
}

/// What the removal of the knot flat[r], the last of its multiplicity s, would change at least.
double removalChange(const Knots& knots, const Rows& poles, std::size_t r, std::size_t s,
                     int stride) {
  const auto p = static_cast<std::size_t>(knots.degree);
  const std::vector<double>& flat = knots.flat;
  const double u = flat[r];
  std::size_t i = r - p;
  std::size_t j = r - s;
  Eigen::RowVectorXd fromLeft = poles.row(at(i - 1));
  Eigen::RowVectorXd fromRight = poles.row(at(j + 1));
  while (j > i) {
    const double a = (u - flat[i]) / (flat[i + p + 1] - flat[i]);
    const double b = (u - flat[j]) / (flat[j + p + 1] - flat[j]);
    fromLeft = (poles.row(at(i)) - (1 - a) * fromLeft) / a;
    fromRight = (poles.row(at(j)) - b * fromRight) / (1 - b);
    ++i;
    --j;
  }
  if (j < i) return change(fromLeft - fromRight, stride);
  const double a = (u - flat[i]) / (flat[i + p + 1] - flat[i]);
  return change(poles.row(at(i)) - (a * fromRight + (1 - a) * fromLeft), stride);
}

struct Removal {
  double knot = 0;
  double change = 0;
};

/// One for each distinct inner knot, least change first.
std::vector<Removal> removals(const Knots& knots, const Rows& poles, int stride) {
  std::vector<Removal> result;
  const std::size_t order = static_cast<std::size_t>(knots.degree) + 1;
  std::size_t multiplicity = 0;
  for (std::size_t r = order; r + order < knots.flat.size(); ++r) {
    ++multiplicity;
    if (knots.flat[r] == knots.flat[r + 1]) continue;
    result.push_back({knots.flat[r], removalChange(knots, poles, r, multiplicity, stride)});
    multiplicity = 0;
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const Removal& a, const Removal& b) { return a.change < b.change; });
  return result;
}

Knots without(const Knots& knots, std::span<const double> removed) {
  Knots result = knots;
  for (const double knot : removed)
    result.flat.erase(std::lower_bound(result.flat.begin(), result.flat.end(), knot));
  return result;
}

/// Candidates of one round: least change first, no two neighbours, whose changes would add up.
std::vector<double> independent(const Knots& knots, const std::vector<Removal>& all) {
  const std::vector<double> ends = knots.distinct();
  std::vector<bool> taken(ends.size(), false);
  std::vector<double> result;
  for (const Removal& removal : all) {
    const auto k = static_cast<std::size_t>(
        std::lower_bound(ends.begin(), ends.end(), removal.knot) - ends.begin());
    if (taken[k - 1] || taken[k + 1]) continue;
    taken[k] = true;
    result.push_back(removal.knot);
  }
  return result;
}

/// Takes knots away as long as a fit to the samples stays within the tolerance.
class KnotRemoval {
 public:
  KnotRemoval(std::vector<double> parameters, Rows values, int stride, double tolerance)
      : parameters_(std::move(parameters)),
        values_(std::move(values)),
        stride_(stride),
        tolerance_(tolerance) {}

  [[nodiscard]] Knots run(Knots knots) const {
    while (knots.poleCount() > static_cast<std::size_t>(knots.degree) + 1) {
      const std::optional<Knots> fewer = fewerThan(knots);
      if (!fewer) break;
      knots = *fewer;
    }
    return knots;
  }

 private:
  [[nodiscard]] bool fits(const Knots& knots) const {
    const BasisRows basis(knots, parameters_);
    const Rows poles = fitPoles(basis, values_);
    if (poles.size() == 0) return false;
    const Rows fitted = basis.times(poles);
    for (Eigen::Index i = 0; i < fitted.rows(); ++i) {
      if (!(apart(fitted.row(i), values_.row(i), stride_) <= tolerance_)) return false;
    }
    return true;
  }

  [[nodiscard]] std::optional<Knots> fewerThan(const Knots& knots) const {
    const Rows poles = fitPoles(BasisRows(knots, parameters_), values_);
    const std::vector<Removal> all = removals(knots, poles, stride_);
    const std::vector<double> candidates = independent(knots, all);
    // Bisection for how many of the candidates can go.
    std::size_t can = 0;
    std::size_t cannot = candidates.size() + 1;
    while (can + 1 < cannot) {
      const std::size_t middle = (can + cannot) / 2;
      if (fits(without(knots, std::span(candidates).first(middle))))
        can = middle;
      else
        cannot = middle;
    }
    if (can > 0) return without(knots, std::span(candidates).first(can));
    for (std::size_t k = 0; k < std::min<std::size_t>(all.size(), kSingles); ++k) {
      const Knots fewer = without(knots, std::span(&all[k].knot, 1));
      if (fits(fewer)) return fewer;
    }
    return std::nullopt;
  }

  std::vector<double> parameters_;
  Rows values_;
  int stride_;
  double tolerance_;
};

/// The knots of `original` as often as curves one time less smooth there need them.
Knots naturalKnots(const Knots& original, int degree) {
  Knots result{degree, {}};
  const std::vector<double> ends = original.distinct();
  for (std::size_t k = 0; k < ends.size(); ++k) {
    const auto range = std::equal_range(original.flat.begin(), original.flat.end(), ends[k]);
    const int multiplicity = static_cast<int>(range.second - range.first);
    const bool inner = k > 0 && k + 1 < ends.size();
    const int smoothness = original.degree - multiplicity - 1;
    const int times = inner ? std::clamp(degree - smoothness, 1, degree) : degree + 1;
    result.flat.insert(result.flat.end(), static_cast<std::size_t>(times), ends[k]);
  }
  return result;
}

}  // namespace

double apart(const Eigen::Ref<const Eigen::RowVectorXd>& a,
             const Eigen::Ref<const Eigen::RowVectorXd>& b, int stride) {
  double most = 0;
  for (Eigen::Index k = 0; k + 2 < a.size(); k += stride) {
    Eigen::RowVector3d gap = a.segment<3>(k) - b.segment<3>(k);
    if (stride == 4) gap = a.segment<3>(k) / a[k + 3] - b.segment<3>(k) / b[k + 3];
    const double square = gap.squaredNorm();
    if (!std::isfinite(square)) return kInfinite;
    most = std::max(most, square);
  }
  return std::sqrt(most);
}

Rows fittedPoles(const CurveBundle& curves, const Knots& knots) {
  const std::vector<double> parameters = densely(knots, samplesPerSpan(knots));
  return fitPoles(BasisRows(knots, parameters), curves.at(parameters));
}

std::optional<Knots> refinedKnots(const CurveBundle& curves, Knots knots, const PolesOf& polesOf,
                                  int order, const KnotLimits& limits) {
  for (int round = 0; round < kMostRounds && knots.poleCount() <= limits.maxPoles; ++round) {
    const std::vector<double> parameters = densely(knots, samplesPerSpan(knots));
    const Rows poles = polesOf(knots);
    if (poles.size() == 0) return std::nullopt;
    const Rows fitted = BasisRows(knots, parameters).times(poles);
    const std::vector<double> errors =
        spanErrors(knots, fitted, curves.at(parameters), curves.stride);
    if (*std::max_element(errors.begin(), errors.end()) <= limits.tolerance) return knots;
    const double domain = knots.last() - knots.first();
    if (narrowest(knots, errors, limits.tolerance) < limits.narrowest * domain) break;
    knots = cut(knots, errors, limits.tolerance, order);
  }
  return std::nullopt;
}

std::optional<Knots> fewestKnots(const CurveBundle& curves, const Knots& original, int degree,
                                 const KnotLimits& limits) {
  const std::optional<Knots> many = refinedKnots(
      curves, naturalKnots(original, degree),
      [&](const Knots& knots) { return fittedPoles(curves, knots); }, degree + 1, limits);
  if (!many) return std::nullopt;
  std::vector<double> parameters = densely(*many, samplesPerSpan(*many));
  Rows values = curves.at(parameters);
  return KnotRemoval(std::move(parameters), std::move(values), curves.stride, limits.tolerance)
      .run(*many);
}

}  // namespace phront
