#include "nurbs/edge_finder.h"

#include <algorithm>
#include <cmath>

#include "nurbs/spline_fit.h"

namespace phront {
namespace {

constexpr double kBesideKnot = 1e-9;   // of a span
constexpr double kLeastCorner = 1e-6;  // rad between normals beside a knot
constexpr double kNarrow = 0.25;  // of the tolerance: a gap that is none, a strip that is an edge
constexpr double kTurn = 0.5;     // rad (chord of the unit sphere) that needs a closer look
constexpr int kSamples = 4;       // inside each span
constexpr int kMostBisections = 40;

}  // namespace

struct EdgeFinder::Line {
  const std::function<Vec3(double)>& normal;
  const std::function<Vec3(double)>& point;
};

void EdgeFinder::look(const std::function<Vec3(double)>& normal,
                      const std::function<Vec3(double)>& point) {
  const std::vector<double> ends = along_.distinct();
  const Line line{normal, point};
  // A side that is a point (a pole, an apex) is no edge however the normals turn there.
  double extent = 0;
  for (const double t : densely(along_, 1))
    extent = std::max(extent, (point(t) - point(ends.front())).norm());
  if (extent <= kNarrow * options_.tolerance) return;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    const double beside = kBesideKnot * (ends[k + 1] - ends[k]);
    const auto at = [&](int i) {
      const double t = ends[k] + (ends[k + 1] - ends[k]) * i / (kSamples + 1);
      return std::clamp(t, ends[k] + beside, ends[k + 1] - beside);
    };
    double length = 0;
    double turn = 0;
    for (int i = 0; i <= kSamples; ++i) {
      length += (point(at(i + 1)) - point(at(i))).norm();
      turn = std::max(turn, (normal(at(i + 1)) - normal(at(0))).norm());
    }
    if (length <= kNarrow * options_.tolerance) {
      if (turn > kTurn) found_.push_back({ends[k], ends[k + 1]});
    } else {
      for (int i = 0; i <= kSamples; ++i)
        lookInside(line, at(i), at(i + 1), normal(at(i)), normal(at(i + 1)), 0);
    }
    if (k == 0) continue;
    const Vec3 before = normal(ends[k] - kBesideKnot * (ends[k] - ends[k - 1]));
    const double jump = (before - normal(at(0))).norm();
    if (jump > kLeastCorner && std::abs(options_.distance) * jump > kNarrow * options_.tolerance)
      found_.push_back({ends[k], ends[k]});
  }
}

void EdgeFinder::lookInside(const Line& line, double low, double high, const Vec3& before,
                            const Vec3& after, int depth) {
  if ((before - after).norm() <= kTurn) return;
  const double middle = 0.5 * (low + high);
  const Vec3 between = line.point(middle);
  const double length = (between - line.point(low)).norm() + (line.point(high) - between).norm();
  if (length <= kNarrow * options_.tolerance || depth == kMostBisections) {
    found_.push_back({low, high});
    return;
  }
  const Vec3 normal = line.normal(middle);
  lookInside(line, low, middle, before, normal, depth + 1);
  lookInside(line, middle, high, normal, after, depth + 1);
}

std::vector<Interval> EdgeFinder::strips() const {
  std::vector<Interval> all = found_;
  std::sort(all.begin(), all.end(),
            [](const Interval& a, const Interval& b) { return a.low < b.low; });
  // What lies beside a knot, or no farther from another strip than that is wide, belongs to it.
  const double near = 2 * kBesideKnot * (along_.last() - along_.first());
  std::vector<Interval> result;
  for (Interval strip : all) {
    if (strip.low < along_.first() + near) strip.low = along_.first();
    if (strip.high > along_.last() - near) strip.high = along_.last();
    if (!result.empty()) {
      Interval& last = result.back();
      const double width = std::max(strip.high - strip.low, last.high - last.low);
      if (strip.low - last.high <= std::max(near, width)) {
        last.high = std::max(last.high, strip.high);
        continue;
      }
    }
    result.push_back(strip);
  }
  return result;
}

}  // namespace phront
