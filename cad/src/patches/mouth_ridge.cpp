// Followed by Newton's method from its middle to both tips, first coarsely, to see which strips
// meet; then each piece between two such strips finely. At the tips both pipes are singular and
// tangent to each other, and every quantity is even in the distance from the tip: the last steps
// are extrapolated. An error there moves points along the pipes, not off them.
#include "patches/mouth_ridge.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace phront::cad {
namespace {

constexpr int kCoarse = 24;         // steps from the middle to a tip
constexpr int kFine = 32;           // in a piece
constexpr double kUnsolved = 0.35;  // share of such steps next to a tip that may be extrapolated
constexpr int kNewtonSteps = 20;
constexpr int kHalvings = 20;
constexpr double kSolved = 1;        // tolerances: the two pipes meet
constexpr double kInertia = 1e-2;    // of |d|, for a strip's length, at first: see solve
constexpr double kClear = 5;         // tolerances: nearer to a rim than |d| by more is on no offset
constexpr double kTipsAgree = 1e-2;  // of |d|: the tip as either half has it
constexpr double kLongestStep = 0.1;  // of a strip, in a step of Newton's method
constexpr double kBeyond = 0.05;    // of a strip: the other's surface may be needed so far past it
constexpr double kShortest = 1e-3;  // of |d|: a shorter piece is but a point, as on a circle
constexpr double kNearEnd = 0.02;   // of a strip

Eigen::Vector3d toEigen(const gp_XYZ& p) { return {p.X(), p.Y(), p.Z()}; }

std::size_t stripOf(double s, const MouthStrips& strips) {
  return static_cast<std::size_t>(std::clamp(s, 0.0, static_cast<double>(strips.size()) - 0.5));
}

/// Half way along all of them.
double middleOf(const MouthStrips& strips) {
  double rest = 0;
  for (const MouthStrip& strip : strips) rest += strip.length() / 2;
  for (std::size_t i = 0; i < strips.size(); ++i) {
    const double length = strips[i].length();
    if (rest < length) return static_cast<double>(i) + rest / length;
    rest -= length;
  }
  return static_cast<double>(strips.size()) / 2;
}

/// Which of the two places along the halves is given.
enum class Given { S, OtherS };

class Ridge {
 public:
  Ridge(const MouthStrips& a, const MouthStrips& b) : a_(a), b_(b), d_(a.front().frame().radius) {}

  std::optional<std::vector<RidgePiece>> run() {
    const std::optional<RidgePoint> middle = start();
    if (!middle) return std::nullopt;
    const auto back = march(*middle, 0);
    const auto onward = march(*middle, static_cast<double>(a_.size()));
    if (!back || !onward) return std::nullopt;
    coarse_.assign(back->rbegin(), back->rend());
    coarse_.insert(coarse_.end(), onward->begin() + 1, onward->end());
    return pieces();
  }

 private:
  [[nodiscard]] bool clear(const gp_Pnt& p) const {
    for (const MouthStrips* half : {&a_, &b_})
      for (const MouthStrip& strip : *half)
        if (strip.nearest(p).first < d_ - kClear * strip.frame().tolerance) return false;
    return true;
  }

  /// Where the strips i and j meet, from the places and the point of `p`, of which one place stays.
  /// False when they do not within [0, 1] of either, across; along they may a little beyond. Near
  /// the fold a pipe hardly changes along the rim (on a circle not at all), so that the place on it
  /// is ill determined, and of no consequence: it is made reluctant to move (Levenberg 1944).
  [[nodiscard]] bool solve(RidgePoint& p, std::size_t i, std::size_t j,
                           Given given = Given::S) const {
    const auto at = [](std::size_t strip) { return static_cast<double>(strip); };
    p.u = a_[i].across(p.s - at(i), p.point);
    p.otherU = b_[j].across(p.otherS - at(j), p.point);
    double inertia = kInertia * d_;
    for (int step = 0; step < kNewtonSteps; ++step, inertia /= 2) {
      gp_Pnt onA;
      gp_Pnt onB;
      gp_Vec aF;
      gp_Vec aU;
      gp_Vec bF;
      gp_Vec bU;
      a_[i].derivatives(p.s - at(i), p.u, onA, aF, aU);
      b_[j].derivatives(p.otherS - at(j), p.otherU, onB, bF, bU);
      p.point = gp_Pnt((onA.XYZ() + onB.XYZ()) / 2);
      const auto near = [&](double s, std::size_t strip, double beyond) {
        return s > at(strip) - beyond && s < at(strip) + 1 + beyond;
      };
      if (onA.Distance(onB) < kSolved * a_[i].frame().tolerance)
        return p.u > 0 && p.u < 1 && p.otherU > 0 && p.otherU < 1 && near(p.s, i, kBeyond) &&
               near(p.otherS, j, kBeyond) && clear(p.point);
      Eigen::Matrix3d jacobian;
      jacobian << toEigen(aU.XYZ()), -toEigen(bU.XYZ()),
          given == Given::S ? Eigen::Vector3d(-toEigen(bF.XYZ())) : toEigen(aF.XYZ());
      Eigen::Matrix3d normal = jacobian.transpose() * jacobian;
      normal(2, 2) += inertia * inertia;
      Eigen::Vector3d change =
          normal.ldlt().solve(jacobian.transpose() * toEigen(onB.XYZ() - onA.XYZ()));
      if (!change.allFinite()) return false;
      change *= std::min(1.0, kLongestStep / change.cwiseAbs().maxCoeff());
      p.u += change[0];
      p.otherU += change[1];
      (given == Given::S ? p.otherS : p.s) += change[2];
      const bool inside = p.u > -1 && p.u < 2 && p.otherU > -1 && p.otherU < 2 && near(p.s, i, 1) &&
                          near(p.otherS, j, 1);
      if (!inside) return false;
    }
    return false;
  }

  /// A place on the other half and how far away it is.
  struct Nearest {
    double distance = std::numeric_limits<double>::infinity();
    double otherS = 0;
  };

  [[nodiscard]] Nearest nearestOf(const gp_Pnt& p) const {
    Nearest best;
    for (std::size_t j = 0; j < b_.size(); ++j) {
      const auto [distance, f] = b_[j].nearest(p);
      if (distance < best.distance) best = {distance, static_cast<double>(j) + f};
    }
    return best;
  }

  [[nodiscard]] Nearest middleAsNearest(const gp_Pnt& p) const {
    const double s = middleOf(b_);
    const std::size_t j = stripOf(s, b_);
    const double t = b_[j].parameter(s - static_cast<double>(j));
    return {p.Distance(b_[j].sections().section(t).centre), s};
  }

  /// On the section through the middle of the first half, where it comes nearer than |d| to the
  /// other.
  template <class NearestTo>
  [[nodiscard]] std::optional<RidgePoint> startBy(NearestTo&& nearest) const {
    RidgePoint p;
    p.s = middleOf(a_);
    const std::size_t i = stripOf(p.s, a_);
    const double f = p.s - static_cast<double>(i);
    double far = 0;
    double near = 1;
    for (int k = 0; k < kHalvings; ++k) {
      const double share = (far + near) / 2;
      (nearest(a_[i].onSection(f, share)).distance >= d_ ? far : near) = share;
    }
    p.point = a_[i].onSection(f, far);
    p.otherS = nearest(p.point).otherS;
    if (!solve(p, i, stripOf(p.otherS, b_))) return std::nullopt;
    return p;
  }

  /// The nearest point is ill determined where the other half curves about it, so that its middle
  /// is tried first.
  [[nodiscard]] std::optional<RidgePoint> start() const {
    const auto byMiddle = startBy([&](const gp_Pnt& p) { return middleAsNearest(p); });
    return byMiddle ? byMiddle : startBy([&](const gp_Pnt& p) { return nearestOf(p); });
  }

  /// From `middle` towards the tip at s = `end`, without it.
  [[nodiscard]] std::optional<std::vector<RidgePoint>> march(const RidgePoint& middle,
                                                             double end) const {
    const double otherEnd = end == 0 ? 0 : static_cast<double>(b_.size());
    std::vector<RidgePoint> points{middle};
    for (int k = 1; k < kCoarse; ++k) {
      // Closer together towards the tip.
      const double s = middle.s + (end - middle.s) * std::sin(M_PI / 2 * k / kCoarse);
      const RidgePoint& last = points.back();
      RidgePoint p = last;
      p.s = s;
      p.otherS = otherEnd + (last.otherS - otherEnd) * (end - s) / (end - last.s);
      if (points.size() > 1) {
        const RidgePoint& before = points[points.size() - 2];
        const double slope = (s - last.s) / (last.s - before.s);
        p.point.Translate(gp_Vec(before.point, last.point) * slope);
      }
      if (!solveAnywhere(p) || (p.otherS - last.otherS) * (otherEnd - last.otherS) <= 0) {
        if (k < (1 - kUnsolved) * kCoarse) return std::nullopt;
        break;
      }
      points.push_back(p);
    }
    return points;
  }

  /// On whichever strip of the other half it lies.
  [[nodiscard]] bool solveAnywhere(RidgePoint& p) const {
    const std::size_t i = stripOf(p.s, a_);
    const RidgePoint guess = p;
    std::size_t j = stripOf(p.otherS, b_);
    for (std::size_t tries = 0; tries < b_.size(); ++tries) {
      p = guess;
      const auto from = static_cast<double>(j);
      p.otherS = std::clamp(p.otherS, from, from + 1);
      if (solve(p, i, j) && p.otherS >= from && p.otherS <= from + 1) return true;
      if (p.otherS > from + 1 && j + 1 < b_.size())
        ++j;
      else if (p.otherS < from && j > 0)
        --j;
      else
        return false;
    }
    return false;
  }

  /// Between the coarse points, linearly in s (or in otherS).
  [[nodiscard]] RidgePoint guess(double at, Given given) const {
    const auto place = [&](const RidgePoint& p) { return given == Given::S ? p.s : p.otherS; };
    std::size_t k = 1;
    while (k + 1 < coarse_.size() && place(coarse_[k]) < at) ++k;
    const RidgePoint& a = coarse_[k - 1];
    const RidgePoint& b = coarse_[k];
    const double share = (at - place(a)) / (place(b) - place(a));
    RidgePoint p;
    p.s = std::lerp(a.s, b.s, share);
    p.otherS = std::lerp(a.otherS, b.otherS, share);
    p.point = a.point.Translated(gp_Vec(a.point, b.point) * share);
    return p;
  }

  /// To the end of the other half's strip nearby, if it is as good a place: then both halves pass
  /// from one strip to the next there.
  void moveToEnd(RidgePoint& p) const {
    const double end = std::round(p.otherS);
    if (std::abs(p.otherS - end) > kNearEnd || end < 1 || end > static_cast<double>(b_.size()) - 1)
      return;
    const MouthStrip& strip = b_[static_cast<std::size_t>(end)];
    const double gap = strip.value(0, strip.across(0, p.point)).Distance(p.point);
    if (gap < kSolved * strip.frame().tolerance) p.otherS = end;
  }

  /// Where the ridge passes from one strip to the next, in either half.
  [[nodiscard]] std::optional<std::vector<RidgePoint>> breaks() const {
    std::vector<RidgePoint> found;
    for (std::size_t i = 1; i < a_.size(); ++i) {
      RidgePoint p = guess(static_cast<double>(i), Given::S);
      p.s = static_cast<double>(i);
      if (!solveAnywhere(p)) return std::nullopt;
      moveToEnd(p);
      found.push_back(p);
    }
    for (std::size_t j = 1; j < b_.size(); ++j) {
      const auto at = static_cast<double>(j);
      const bool known = std::any_of(found.begin(), found.end(),
                                     [&](const RidgePoint& p) { return p.otherS == at; });
      if (known) continue;
      RidgePoint p = guess(at, Given::OtherS);
      p.otherS = at;
      if (!solve(p, stripOf(p.s, a_), j, Given::OtherS)) return std::nullopt;
      found.push_back(p);
    }
    std::sort(found.begin(), found.end(),
              [](const RidgePoint& p, const RidgePoint& q) { return p.s < q.s; });
    return found;
  }

  [[nodiscard]] std::optional<std::vector<RidgePiece>> pieces() const {
    const std::optional<std::vector<RidgePoint>> inner = breaks();
    if (!inner) return std::nullopt;
    std::vector<RidgePiece> found;
    for (std::size_t k = 0; k <= inner->size(); ++k) {
      const RidgePoint* from = k == 0 ? nullptr : &(*inner)[k - 1];
      const RidgePoint* to = k == inner->size() ? nullptr : &(*inner)[k];
      std::optional<RidgePiece> piece = pieceBetween(from, to);
      if (!piece || lengthOf(*piece) < kShortest * d_) return std::nullopt;
      found.push_back(std::move(*piece));
    }
    return found;
  }

  static double lengthOf(const RidgePiece& piece) {
    double sum = 0;
    for (std::size_t k = 1; k < piece.points.size(); ++k)
      sum += piece.points[k].point.Distance(piece.points[k - 1].point);
    return sum;
  }

  /// Null ends are tips.
  [[nodiscard]] std::optional<RidgePiece> pieceBetween(const RidgePoint* from,
                                                       const RidgePoint* to) const {
    const double s0 = from ? from->s : 0;
    const double s1 = to ? to->s : static_cast<double>(a_.size());
    const double other0 = from ? from->otherS : 0;
    const double other1 = to ? to->otherS : static_cast<double>(b_.size());
    RidgePiece piece;
    piece.strip = stripOf((s0 + s1) / 2, a_);
    piece.otherStrip = stripOf((other0 + other1) / 2, b_);
    std::vector<std::optional<RidgePoint>> points(kFine + 1);
    for (int k = 0; k <= kFine; ++k) {
      if ((k == 0 && !from) || (k == kFine && !to)) continue;
      const double share = static_cast<double>(k) / kFine;
      RidgePoint p;
      p.s = std::lerp(s0, s1, spaced(share, !from, !to));
      if (k == 0 || k == kFine) {
        p = k == 0 ? *from : *to;
        // Strips that meet in a section need not divide it alike.
        p.u = a_[piece.strip].across(p.s - static_cast<double>(piece.strip), p.point);
        p.otherU =
            b_[piece.otherStrip].across(p.otherS - static_cast<double>(piece.otherStrip), p.point);
      } else {
        const double at = p.s;
        p = guess(at, Given::S);
        p.s = at;
        if (!solve(p, piece.strip, piece.otherStrip)) continue;
      }
      points[static_cast<std::size_t>(k)] = p;
    }
    std::optional<std::vector<RidgePoint>> run = growingRun(points, !from, !to);
    if (!run) return std::nullopt;
    piece.points = std::move(*run);
    if (!from && !addTip(piece, 0)) return std::nullopt;
    if (!to && !addTip(piece, static_cast<double>(a_.size()))) return std::nullopt;
    return piece;
  }

  /// All the points; next to tips some may be missing. nullopt when others are, or when the places
  /// do not grow.
  static std::optional<std::vector<RidgePoint>> growingRun(
      const std::vector<std::optional<RidgePoint>>& points, bool tipFirst, bool tipLast) {
    const auto solved = [](const std::optional<RidgePoint>& p) { return p.has_value(); };
    const auto first = std::find_if(points.begin(), points.end(), solved);
    const auto last = std::find_if(points.rbegin(), points.rend(), solved).base();
    const auto dispensable = [](bool tip) { return tip ? static_cast<int>(kUnsolved * kFine) : 0; };
    if (first - points.begin() > dispensable(tipFirst) ||
        points.end() - last > dispensable(tipLast) || !std::all_of(first, last, solved))
      return std::nullopt;
    std::vector<RidgePoint> run;
    for (auto it = first; it != last; ++it) run.push_back(**it);
    const auto stalls = [](const RidgePoint& p, const RidgePoint& q) {
      return p.s >= q.s || p.otherS >= q.otherS;
    };
    if (run.size() < 3 || std::adjacent_find(run.begin(), run.end(), stalls) != run.end())
      return std::nullopt;
    return run;
  }

  /// In [0, 1]; closer together towards tips.
  static double spaced(double share, bool tipFirst, bool tipLast) {
    if (tipFirst && tipLast) return (1 - std::cos(M_PI * share)) / 2;
    if (tipFirst) return 1 - std::cos(M_PI / 2 * share);
    if (tipLast) return std::sin(M_PI / 2 * share);
    return share;
  }

  [[nodiscard]] bool addTip(RidgePiece& piece, double end) const {
    const bool atFirst = end == 0;
    const RidgePoint& p1 = atFirst ? piece.points[0] : piece.points.back();
    const RidgePoint& p2 = atFirst ? piece.points[1] : piece.points[piece.points.size() - 2];
    const double otherEnd = atFirst ? 0 : static_cast<double>(b_.size());
    const auto limit = [](double u1, double x1, double u2, double x2) {
      return u1 + (u1 - u2) * x1 * x1 / (x2 * x2 - x1 * x1);
    };
    RidgePoint tip;
    tip.s = end;
    tip.otherS = otherEnd;
    tip.u = limit(p1.u, end - p1.s, p2.u, end - p2.s);
    tip.otherU = limit(p1.otherU, otherEnd - p1.otherS, p2.otherU, otherEnd - p2.otherS);
    const MouthStrip& a = a_[piece.strip];
    const MouthStrip& b = b_[piece.otherStrip];
    const double f = atFirst ? 0 : 1;
    if (tip.u <= 0 || tip.u >= 1) return false;
    tip.point = a.value(f, tip.u);
    if (tip.point.Distance(b.value(f, tip.otherU)) > kTipsAgree * d_) return false;
    tip.otherU = b.across(f, tip.point);
    piece.points.insert(atFirst ? piece.points.begin() : piece.points.end(), tip);
    return true;
  }

  const MouthStrips& a_;
  const MouthStrips& b_;
  double d_;
  std::vector<RidgePoint> coarse_;
};

}  // namespace

std::optional<std::vector<RidgePiece>> followRidge(const MouthStrips& one,
                                                   const MouthStrips& other) {
  return Ridge(one, other).run();
}

}  // namespace phront::cad
