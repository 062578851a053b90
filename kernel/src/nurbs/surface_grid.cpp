#include "nurbs/surface_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <queue>

namespace phront {
namespace {

constexpr double kDegenerate = 1e-8;  // of the typical |S_u x S_v|
constexpr double kIntoDomain = 1e-4;  // of the domain: from where a degenerate normal is taken
constexpr std::size_t kTypicalSamples = 7;
constexpr std::size_t kFoldSamples = 20;  // along a direction, in search of folds
constexpr std::size_t kLeastInSpan = 2;   // of these
constexpr std::size_t kMostFoldSamples = 300;
constexpr double kTurnedOver = -0.5;   // cosine between neighbours' normals
constexpr double kOnFold = 1e-5;       // of the typical |S_u x S_v|: below, normals say nothing
constexpr double kBesideFold = 0.1;    // the same: below, they may swing
constexpr double kOnRoot = 1e-11;      // the same: along the normal, none
constexpr double kMostResidue = 1e-3;  // the same: more is no fold
constexpr int kSecants = 12;

/// Parameters all over a domain, in each span some unless there are very many.
std::vector<double> spreadOver(const Knots& knots) {
  const std::size_t spans = knots.distinct().size() - 1;
  std::size_t each = std::clamp(kFoldSamples / spans, kLeastInSpan, kFoldSamples);
  if (each * spans > kMostFoldSamples) each = std::max<std::size_t>(1, kMostFoldSamples / spans);
  return densely(knots, static_cast<int>(each));
}

Eigen::Index index(std::size_t i) { return static_cast<Eigen::Index>(i); }

/// Homogeneous poles: a row for each u, (w x, w y, w z, w) for each v.
Rows liftedPoles(const NurbsSurface& surface) {
  const std::size_t columns = surface.v.poleCount();
  const std::size_t rows = surface.u.poleCount();
  Rows result(index(rows), index(4 * columns));
  for (std::size_t j = 0; j < columns; ++j) {
    for (std::size_t i = 0; i < rows; ++i) {
      const std::size_t n = i + j * rows;
      const double w = surface.weights.empty() ? 1 : surface.weights[n];
      result.block<1, 3>(index(i), index(4 * j)) = w * surface.poles[n].transpose();
      result(index(i), index(4 * j + 3)) = w;
    }
  }
  return result;
}

/// A surface at the pairs of some parameters: sums along u are done once.
class Lifted {
 public:
  Lifted(const NurbsSurface& surface, std::span<const double> us, std::span<const double> vs)
      : inV_(surface.v, vs) {
    const Rows poles = liftedPoles(surface);
    const BasisRows inU(surface.u, us);
    values_ = inU.times(poles);
    slopes_ = inU.slopeTimes(poles);
  }

  [[nodiscard]] SurfacePoint at(std::size_t i, std::size_t j) const {
    const BasisAt& v = inV_[j];
    const Eigen::Vector4d p = sum(values_, i, v.first, v.value);
    const Eigen::Vector4d alongU = sum(slopes_, i, v.first, v.value);
    const Eigen::Vector4d alongV = sum(values_, i, v.first, v.slope);
    SurfacePoint point;
    point.position = p.head<3>() / p[3];
    point.alongU = (alongU.head<3>() - alongU[3] * point.position) / p[3];
    point.alongV = (alongV.head<3>() - alongV[3] * point.position) / p[3];
    point.weight = p[3];
    return point;
  }

 private:
  template <class Factors>
  [[nodiscard]] Eigen::Vector4d sum(const Rows& rows, std::size_t i, std::size_t first,
                                    const Factors& factors) const {
    Eigen::Vector4d result = Eigen::Vector4d::Zero();
    for (std::size_t k = 0; k < inV_.order(); ++k)
      result += factors[k] * rows.block<1, 4>(index(i), index(4 * (first + k))).transpose();
    return result;
  }

  BasisRows inV_;
  Rows values_, slopes_;
};

}  // namespace

bool isRational(const std::vector<double>& weights) {
  if (weights.empty()) return false;
  const auto [least, most] = std::minmax_element(weights.begin(), weights.end());
  return *most - *least > 1e-14 * *most;
}

SurfaceGrid gridOf(const NurbsSurface& surface, std::span<const double> us,
                   std::span<const double> vs) {
  const Lifted lifted(surface, us, vs);
  SurfaceGrid grid{Rows(index(us.size()), index(3 * vs.size())),
                   Rows(index(us.size()), index(3 * vs.size()))};
  for (std::size_t i = 0; i < us.size(); ++i) {
    for (std::size_t j = 0; j < vs.size(); ++j) {
      const SurfacePoint p = lifted.at(i, j);
      grid.points.block<1, 3>(index(i), index(3 * j)) = p.position.transpose();
      grid.crosses.block<1, 3>(index(i), index(3 * j)) = p.alongU.cross(p.alongV).transpose();
    }
  }
  return grid;
}

OffsetSurface::OffsetSurface(const NurbsSurface& surface, double distance)
    : surface_(surface), distance_(distance), rational_(isRational(surface.weights)) {
  const auto spread = [](const Knots& knots, std::size_t i) {
    return knots.first() +
           (knots.last() - knots.first()) * static_cast<double>(i) / (kTypicalSamples - 1);
  };
  for (std::size_t i = 0; i < kTypicalSamples; ++i) {
    for (std::size_t j = 0; j < kTypicalSamples; ++j)
      typical_ = std::max(typical_, cross(spread(surface.u, i), spread(surface.v, j)).norm());
  }
  if (typical_ > 0) findFolds();
}

void OffsetSurface::findFolds() {
  const std::vector<double> us = spreadOver(surface_.u);
  const std::vector<double> vs = spreadOver(surface_.v);
  const Rows crosses = gridOf(surface_, us, vs).crosses;
  std::vector<Vec3> normals;
  std::vector<double> lengths;
  for (std::size_t j = 0; j < vs.size(); ++j) {
    for (std::size_t i = 0; i < us.size(); ++i) {
      const Vec3 cross = crosses.block<1, 3>(index(i), index(3 * j)).transpose();
      lengths.push_back(cross.norm());
      normals.push_back(lengths.back() > kDegenerate * typical_ ? Vec3(cross / lengths.back())
                                                                : normal(us[i], vs[j]));
    }
  }
  const std::size_t rows = us.size();
  const auto neighbours = [&](std::size_t n, std::size_t away) {
    std::vector<std::size_t> result;
    if (n % rows >= away) result.push_back(n - away);
    if (n % rows + away < rows) result.push_back(n + away);
    if (n >= away * rows) result.push_back(n - away * rows);
    if (n + away * rows < normals.size()) result.push_back(n + away * rows);
    return result;
  };
  bool folded = false;
  for (std::size_t n = 0; n < normals.size() && !folded; ++n) {
    for (const std::size_t m : neighbours(n, 1)) folded |= normals[n].dot(normals[m]) < kTurnedOver;
  }
  if (!folded) return;
  // From the node that is stretched most, over the pairs that agree best (but for the sign). Nodes
  // on a fold, where normals swing, are stepped over; last they take their neighbours'.
  struct Step {
    double agreement = 0;
    std::size_t from = 0, to = 0;
    bool operator<(const Step& other) const { return agreement < other.agreement; }
  };
  const auto clear = [&](std::size_t n) { return lengths[n] >= kOnFold * typical_; };
  const auto start =
      static_cast<std::size_t>(std::max_element(lengths.begin(), lengths.end()) - lengths.begin());
  std::vector<bool> done(normals.size(), false);
  std::priority_queue<Step> open;
  open.push({1, start, start});
  while (!open.empty()) {
    const Step step = open.top();
    open.pop();
    if (done[step.to]) continue;
    done[step.to] = true;
    Vec3& normal = normals[step.to];
    const Vec3& known = normals[step.from];
    if (!clear(step.to))
      normal = known;
    else if (normal.dot(known) < 0)
      normal *= -1;
    for (const std::size_t away : {std::size_t{1}, std::size_t{2}}) {
      for (const std::size_t next : neighbours(step.to, away)) {
        const double agreement = clear(next) ? std::abs(normal.dot(normals[next])) : -1;
        if (!done[next]) open.push({agreement, step.to, next});
      }
    }
  }
  us_ = us;
  vs_ = vs;
  normals_ = std::move(normals);
}

Vec3 OffsetSurface::unfolded(double u, double v, const Vec3& normal) const {
  if (normals_.empty()) return normal;
  return normal.dot(turnedLike(u, v)) < 0 ? Vec3(-normal) : normal;
}

const Vec3& OffsetSurface::turnedLike(double u, double v) const {
  const auto nearest = [](const std::vector<double>& all, double t) {
    const auto after = std::lower_bound(all.begin() + 1, all.end() - 1, t);
    return static_cast<std::size_t>(after - all.begin()) - (*after - t > t - *(after - 1) ? 1 : 0);
  };
  return normals_[nearest(us_, u) + nearest(vs_, v) * us_.size()];
}

Vec3 OffsetSurface::cross(double u, double v) const {
  const SurfacePoint p = evaluate(surface_, u, v);
  return p.alongU.cross(p.alongV);
}

Vec3 OffsetSurface::normal(double u, double v) const { return normal(u, v, cross(u, v)); }

Vec3 OffsetSurface::normal(double u, double v, const Vec3& cross) const {
  const double length = cross.norm();
  if (smoothed_ && length < kBesideFold * typical_) {
    // All of the residue in the inner half, none at the rim.
    const double share = std::min(1.0, 2 - 2 * length / (kBesideFold * typical_));
    const Vec3 clean = cross - share * residue(u, v);
    if (clean.norm() > kDegenerate * typical_) return unfolded(u, v, clean.normalized());
  }
  return length > kDegenerate * typical_ ? unfolded(u, v, cross / length) : limit(u, v);
}

Vec3 OffsetSurface::limit(double u, double v) const {
  const Vec3 here = cross(u, v);
  const auto inward = [](const Knots& knots, double t, double steps) {
    const double middle = 0.5 * (knots.first() + knots.last());
    const double step = steps * kIntoDomain * (knots.last() - knots.first());
    return t + std::copysign(step, middle - t);
  };
  // Straight inwards along v, along u, or both: where the surface is least degenerate. From three
  // points the limit is extrapolated.
  std::array<Vec3, 3> inside{here, here, here};
  for (const auto& [a, b] : {std::pair{0, 1}, {1, 0}, {1, 1}}) {
    const auto at = [&](int k) {
      return cross(inward(surface_.u, u, k * a), inward(surface_.v, v, k * b));
    };
    const Vec3 first = at(1);
    if (first.norm() > inside[0].norm()) inside = {first, at(2), at(3)};
  }
  for (Vec3& n : inside) {
    if (!(n.norm() > 0)) return Vec3::Zero();
    n.normalize();
  }
  const Vec3 limit = 3 * inside[0] - 3 * inside[1] + inside[2];
  return unfolded(u, v, limit.normalized());
}

std::optional<Vec3> OffsetSurface::residueAlong(bool alongU, double u, double v) const {
  const Knots& knots = alongU ? surface_.u : surface_.v;
  const Vec3& like = turnedLike(u, v);
  const auto at = [&](double t) { return alongU ? cross(t, v) : cross(u, t); };
  const double start = alongU ? u : v;
  const double step = kIntoDomain * (knots.last() - knots.first());
  // Secants to where S_u x S_v has no part along the normal.
  double before = start + step <= knots.last() ? start + step : start - step;
  double valueBefore = at(before).dot(like);
  double here = start;
  for (int i = 0; i < kSecants; ++i) {
    const Vec3 c = at(here);
    const double value = c.dot(like);
    if (std::abs(value) <= kOnRoot * typical_) {
      const Vec3 kept = c - value * like;
      // Else not on a fold, but where the normal has turned away.
      return kept.norm() <= kMostResidue * typical_ ? std::optional(kept) : std::nullopt;
    }
    if (value == valueBefore) return std::nullopt;
    const double next = here - value * (here - before) / (value - valueBefore);
    if (!(knots.first() <= next && next <= knots.last())) return std::nullopt;
    before = here;
    valueBefore = value;
    here = next;
  }
  return std::nullopt;
}

Vec3 OffsetSurface::residue(double u, double v) const {
  const auto alongU = residueAlong(true, u, v);
  const auto alongV = residueAlong(false, u, v);
  if (alongU && alongV) return 0.5 * (*alongU + *alongV);
  return alongU ? *alongU : alongV.value_or(Vec3::Zero());
}

Vec3 OffsetSurface::point(double u, double v) const {
  return evaluate(surface_, u, v).position + distance_ * normal(u, v);
}

Rows OffsetSurface::at(std::span<const double> us, std::span<const double> vs) const {
  const Lifted lifted(surface_, us, vs);
  const int wide = stride();
  Rows result(index(us.size()), index(vs.size()) * wide);
  for (std::size_t i = 0; i < us.size(); ++i) {
    for (std::size_t j = 0; j < vs.size(); ++j) {
      const SurfacePoint p = lifted.at(i, j);
      const Vec3 moved = p.position + distance_ * normal(us[i], vs[j], p.alongU.cross(p.alongV));
      const Eigen::Index column = index(j) * wide;
      result.block<1, 3>(index(i), column) = (rational_ ? p.weight : 1) * moved.transpose();
      if (rational_) result(index(i), column + 3) = p.weight;
    }
  }
  return result;
}

}  // namespace phront
