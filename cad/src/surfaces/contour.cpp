#include "surfaces/contour.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace phront::cad {
namespace {

constexpr double kOnLine = 0.05;  // of the chord: how near a point of the line is to it
constexpr int kBisections = 40;
constexpr int kNewtonSteps = 6;
constexpr double kMostTurn = 0.35;       // rad in one step
constexpr double kMostCorrection = 0.3;  // of a step
constexpr double kCheckedStep = 8;       // chords: shorter steps miss nothing between
constexpr double kShortestStep = 0.5;    // of the chord
constexpr int kDirections = 24;          // looked into at a corner
constexpr int kMostInVain = 4000;        // queries
constexpr int kMostCorners = 12;         // one after the other
constexpr double kSameLine = 3;          // chords: seeds nearer to a line belong to it

Vec2 leftOf(const Vec2& v) { return {-v[1], v[0]}; }

/// A point on the line, on the side without clearance.
struct OnLine {
  Vec2 at;
  Vec2 tangent;  ///< unit; clearance on the left
};

class Tracer {
 public:
  /// `queries` counts them.
  Tracer(const ClearanceAt& clearance, const ContourOptions& options, int& queries)
      : clearance_(clearance), options_(options), queries_(queries) {}

  void run(const std::vector<ContourSeed>& seeds, std::vector<Contour>& lines) const {
    int vain = 0;  // queries for lines that end inside
    for (const ContourSeed& seed : seeds) {
      if (queries_ > options_.maxQueries || vain > kMostInVain) return;
      const std::optional<OnLine> start = between(seed.without, seed.with);
      if (!start || isOn(lines, start->at)) continue;
      const int before = queries_;
      std::optional<Contour> line = traced(*start);
      const bool ends =
          line && !line->closed && (inside(line->points.front()) || inside(line->points.back()));
      if (!line || ends) vain += queries_ - before;
      if (line) lines.push_back(std::move(*line));
    }
  }

 private:
  [[nodiscard]] Clearance look(const Vec2& x) const {
    ++queries_;
    return clearance_(x);
  }

  [[nodiscard]] bool inside(const Vec2& x) const {
    return (x.array() >= options_.low.array()).all() && (x.array() <= options_.high.array()).all();
  }

  [[nodiscard]] std::optional<OnLine> onLine(const Vec2& at, const Clearance& clearance) const {
    const double slope = clearance.gradient.norm();
    if (!(slope > 0) || !std::isfinite(slope)) return std::nullopt;
    // To the left of the tangent the clearance grows.
    const Vec2 up = clearance.gradient / slope;
    return OnLine{at, Vec2(up[1], -up[0])};
  }

  /// Bisection, which needs signs only, then the gradient of the last point without clearance.
  [[nodiscard]] std::optional<OnLine> between(Vec2 without, Vec2 with) const {
    Clearance last = look(without);
    if (!(last.value < 0)) return std::nullopt;
    for (int i = 0; i < kBisections && (with - without).norm() > kOnLine * options_.chord; ++i) {
      const Vec2 middle = 0.5 * (without + with);
      const Clearance here = look(middle);
      if (here.value < 0) {
        without = middle;
        last = here;
      } else {
        with = middle;
      }
    }
    return onLine(without, last);
  }

  /// The point of the line near x; `down` leads to where there is no clearance.
  [[nodiscard]] std::optional<OnLine> corrected(Vec2 x, const Vec2& down, double reach) const {
    Clearance here = look(x);
    if (here.value >= 0) {
      const Vec2 with = x;
      for (double step = std::min(options_.chord, reach); step <= reach; step *= 2) {
        const Vec2 tried = with + step * down;
        if (look(tried).value < 0) return between(tried, with);
      }
      return std::nullopt;
    }
    Vec2 start = x;
    for (int i = 0; i < kNewtonSteps; ++i) {
      const double square = here.gradient.squaredNorm();
      if (!(square > 0)) return std::nullopt;
      if (-here.value <= kOnLine * options_.chord * std::sqrt(square)) return onLine(x, here);
      const Vec2 next = x - (here.value / square) * here.gradient;
      if (!((next - start).norm() <= reach)) return std::nullopt;
      const Clearance there = look(next);
      if (there.value >= 0) return between(x, next);
      x = next;
      here = there;
    }
    return std::nullopt;
  }

  /// Around a corner: the first change on a small circle, turning from where there is clearance.
  [[nodiscard]] std::optional<OnLine> aroundCorner(const OnLine& from, double radius) const {
    const double back = std::atan2(-from.tangent[1], -from.tangent[0]);
    const auto at = [&](int k) {
      // Clockwise from straight back, through the side with clearance.
      const double angle = back - 2 * std::numbers::pi * (k + 0.5) / kDirections;
      return Vec2(from.at + radius * Vec2(std::cos(angle), std::sin(angle)));
    };
    std::optional<Vec2> with;
    for (int k = 0; k < kDirections; ++k) {
      const Vec2 x = at(k);
      if (look(x).value >= 0)
        with = x;
      else if (with)
        return between(x, *with);
    }
    return std::nullopt;
  }

  /// Whether the line between two of its points keeps to the chord in the middle, too.
  [[nodiscard]] bool straight(const OnLine& from, const OnLine& to) const {
    const Vec2 along = to.at - from.at;
    if (along.norm() <= kCheckedStep * options_.chord) return true;
    const Vec2 middle = from.at + 0.5 * along;
    const auto there = corrected(middle, -leftOf(from.tangent), kMostCorrection * along.norm());
    return there && (there->at - middle).norm() <= options_.chord;
  }

  [[nodiscard]] std::optional<OnLine> next(const OnLine& from, double& step) const {
    const double shortest = kShortestStep * options_.chord;
    const Vec2 down = -leftOf(from.tangent);
    for (; step >= shortest; step /= 2) {
      const Vec2 predicted = from.at + step * from.tangent;
      const auto to = corrected(predicted, down, kMostCorrection * step);
      if (!to) continue;
      const double turn = std::acos(std::clamp(from.tangent.dot(to->tangent), -1.0, 1.0));
      if (turn > kMostTurn || step * turn / 8 > options_.chord) continue;
      if (!straight(from, *to)) continue;
      if (turn < kMostTurn / 4) step = std::min(2 * step, options_.longestStep);
      return to;
    }
    step = 2 * shortest;
    return aroundCorner(from, step);
  }

  /// From `start` until the line leaves the box, ends, or comes back.
  [[nodiscard]] bool follow(const OnLine& start, Contour& line) const {
    OnLine here = start;
    double step = options_.longestStep / 4;
    double gone = 0;
    int corners = 0;
    while (inside(here.at)) {
      if (queries_ > options_.maxQueries) return false;
      double length = step;
      const std::optional<OnLine> to = next(here, length);
      if (!to) return true;
      // Corner after corner: this is noise, not a line.
      corners = length <= 2 * kShortestStep * options_.chord ? corners + 1 : 0;
      if (corners > kMostCorners) return true;
      const Vec2 move = to->at - here.at;
      // Past the start: the start lies beside this segment.
      const double along = (start.at - here.at).dot(move) / std::max(move.squaredNorm(), 1e-300);
      const double aside = (here.at + std::clamp(along, 0.0, 1.0) * move - start.at).norm();
      if (gone > kSameLine * options_.chord && aside < kSameLine * options_.chord && along > 0 &&
          start.tangent.dot(move) > 0) {
        line.closed = true;
        return true;
      }
      gone += move.norm();
      here = *to;
      step = length;
      line.points.push_back(here.at);
    }
    return true;
  }

  [[nodiscard]] std::optional<Contour> traced(const OnLine& start) const {
    Contour line;
    line.points.push_back(start.at);
    if (!follow(start, line)) return std::nullopt;
    if (line.closed) return line;
    // Backwards: the same with the plane mirrored.
    Contour back;
    const ClearanceAt mirrored = [this](const Vec2& x) {
      Clearance c = clearance_(Vec2(-x[0], x[1]));
      c.gradient[0] = -c.gradient[0];
      return c;
    };
    ContourOptions options = options_;
    options.low[0] = -options_.high[0];
    options.high[0] = -options_.low[0];
    const Vec2 at(-start.at[0], start.at[1]);
    const Vec2 tangent(start.tangent[0], -start.tangent[1]);
    if (!Tracer(mirrored, options, queries_).follow({at, tangent}, back)) return std::nullopt;
    std::vector<Vec2> points;
    for (auto x = back.points.rbegin(); x != back.points.rend(); ++x)
      points.emplace_back(-(*x)[0], (*x)[1]);
    points.insert(points.end(), line.points.begin(), line.points.end());
    line.points = std::move(points);
    return line;
  }

  [[nodiscard]] bool isOn(const std::vector<Contour>& lines, const Vec2& x) const {
    const double near = kSameLine * options_.chord;
    for (const Contour& line : lines) {
      const std::size_t count = line.points.size();
      for (std::size_t i = 0; i + (line.closed ? 0 : 1) < count; ++i) {
        const Vec2& a = line.points[i];
        const Vec2 along = line.points[(i + 1) % count] - a;
        const double t =
            std::clamp((x - a).dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
        if ((a + t * along - x).norm() <= near) return true;
      }
    }
    return false;
  }

  const ClearanceAt& clearance_;
  const ContourOptions& options_;
  int& queries_;
};

}  // namespace

void traceContours(const ClearanceAt& clearance, const std::vector<ContourSeed>& seeds,
                   const ContourOptions& options, std::vector<Contour>& lines) {
  int queries = 0;
  Tracer(clearance, options, queries).run(seeds, lines);
}

}  // namespace phront::cad
