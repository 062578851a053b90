#include "drawing/chain.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <utility>

namespace phront::cad {
namespace {

constexpr int kMostArcPoints = 100'000;

/// A grid of cells as large as the tolerance: ends near one another lie in the same or next cells.
class EndIndex {
 public:
  explicit EndIndex(double tolerance) : tolerance_(tolerance) {}

  void add(const Vec2& p, std::size_t end) { cells_[cellOf(p)].push_back({p, end}); }
  void remove(const Vec2& p, std::size_t end) {
    std::vector<Entry>& cell = cells_[cellOf(p)];
    cell.erase(
        std::remove_if(cell.begin(), cell.end(), [&](const Entry& e) { return e.end == end; }),
        cell.end());
  }
  /// The nearest other end within the tolerance.
  [[nodiscard]] std::optional<std::size_t> nearest(const Vec2& p, std::size_t self) const {
    std::optional<std::size_t> best;
    double distance = tolerance_;
    const auto [i, j] = cellOf(p);
    for (long a = i - 1; a <= i + 1; ++a) {
      for (long b = j - 1; b <= j + 1; ++b) {
        const auto cell = cells_.find({a, b});
        if (cell == cells_.end()) continue;
        for (const Entry& e : cell->second) {
          const double d = (e.point - p).norm();
          if (e.end == self || d > distance || (d == distance && best && *best < e.end)) continue;
          distance = d;
          best = e.end;
        }
      }
    }
    return best;
  }

 private:
  struct Entry {
    Vec2 point;
    std::size_t end;
  };
  [[nodiscard]] std::pair<long, long> cellOf(const Vec2& p) const {
    return {static_cast<long>(std::floor(p.x() / tolerance_)),
            static_cast<long>(std::floor(p.y() / tolerance_))};
  }

  double tolerance_;
  std::map<std::pair<long, long>, std::vector<Entry>> cells_;
};

/// Without points that repeat the one before.
void clean(Chain& chain, double tolerance) {
  std::vector<Vec2> points;
  for (const Vec2& p : chain.points) {
    if (points.empty() || (p - points.back()).norm() > 1e-3 * tolerance) points.push_back(p);
  }
  if (points.size() > 1 && (points.front() - points.back()).norm() <= tolerance) {
    const bool loop = chain.closed || points.size() > 3;
    if (loop) points.pop_back();
    chain.closed = loop;
  }
  chain.points = std::move(points);
}

std::vector<Chain> joinEnds(std::vector<Chain> chains, double tolerance) {
  EndIndex ends(tolerance);
  const auto point = [&](std::size_t end) -> const Vec2& {
    const Chain& c = chains[end / 2];
    return end % 2 == 0 ? c.points.front() : c.points.back();
  };
  for (std::size_t c = 0; c < chains.size(); ++c) {
    if (chains[c].closed) continue;
    for (const std::size_t end : {2 * c, 2 * c + 1}) ends.add(point(end), end);
  }
  std::vector<bool> used(chains.size(), false);
  std::vector<Chain> result;
  for (std::size_t c = 0; c < chains.size(); ++c) {
    if (used[c]) continue;
    used[c] = true;
    Chain joined = chains[c];
    if (!joined.closed) {
      ends.remove(point(2 * c), 2 * c);
      ends.remove(point(2 * c + 1), 2 * c + 1);
      // Forwards from its end, then, turned round, from its start.
      for (int turn = 0; turn < 2; ++turn) {
        for (;;) {
          const auto next = ends.nearest(joined.points.back(), static_cast<std::size_t>(-1));
          if (!next) break;
          const std::size_t n = *next / 2;
          used[n] = true;
          ends.remove(point(2 * n), 2 * n);
          ends.remove(point(2 * n + 1), 2 * n + 1);
          std::vector<Vec2> more = chains[n].points;
          if (*next % 2 == 1) std::reverse(more.begin(), more.end());
          joined.points.insert(joined.points.end(), more.begin() + 1, more.end());
        }
        std::reverse(joined.points.begin(), joined.points.end());
      }
      clean(joined, tolerance);
    }
    result.push_back(std::move(joined));
  }
  return result;
}

/// Equal for curves through the same points in the same order, whichever way round and (loops)
/// wherever they start.
using Fingerprint = std::pair<bool, std::vector<std::pair<double, double>>>;

Fingerprint fingerprint(const Chain& chain, double tolerance) {
  std::vector<std::pair<double, double>> forward;
  for (const Vec2& p : chain.points) {
    forward.emplace_back(std::round(p.x() / tolerance), std::round(p.y() / tolerance));
  }
  std::vector<std::pair<double, double>> backward(forward.rbegin(), forward.rend());
  if (chain.closed) {
    for (auto* points : {&forward, &backward}) {
      std::rotate(points->begin(), std::min_element(points->begin(), points->end()), points->end());
    }
  }
  return {chain.closed, std::min(forward, backward)};
}

double areaOf(const std::vector<Vec2>& loop) {
  double twice = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 a = loop[i] - loop.front();
    const Vec2 b = loop[(i + 1) % loop.size()] - loop.front();
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

bool inside(const std::vector<Vec2>& loop, const Vec2& x) {
  bool in = false;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2& a = loop[i];
    const Vec2& b = loop[(i + 1) % loop.size()];
    if ((a.y() <= x.y()) == (b.y() <= x.y())) continue;
    const double at = a.x() + (x.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (at > x.x()) in = !in;
  }
  return in;
}

void orientByNesting(std::vector<Chain>& chains) {
  std::vector<Eigen::AlignedBox2d> boxes;
  for (const Chain& c : chains) {
    Eigen::AlignedBox2d box;
    for (const Vec2& p : c.points) box.extend(p);
    boxes.push_back(box);
  }
  std::vector<bool> hole(chains.size(), false);
  for (std::size_t c = 0; c < chains.size(); ++c) {
    if (!chains[c].closed) continue;
    int depth = 0;
    for (std::size_t other = 0; other < chains.size(); ++other) {
      if (other == c || !chains[other].closed || !boxes[other].contains(boxes[c])) continue;
      if (inside(chains[other].points, chains[c].points.front())) ++depth;
    }
    hole[c] = depth % 2 == 1;
  }
  for (std::size_t c = 0; c < chains.size(); ++c) {
    if (!chains[c].closed) continue;
    if ((areaOf(chains[c].points) < 0) != hole[c]) {
      std::reverse(chains[c].points.begin(), chains[c].points.end());
    }
  }
}

}  // namespace

Drawing assemble(std::vector<Chain> chains, double tolerance) {
  for (Chain& c : chains) clean(c, tolerance);
  const auto drop = [&](const Chain& c) { return c.points.size() < (c.closed ? 3U : 2U); };
  chains.erase(std::remove_if(chains.begin(), chains.end(), drop), chains.end());
  std::set<Fingerprint> seen;
  Drawing drawing;
  std::vector<Chain> once;
  for (Chain& c : chains) {
    if (seen.insert(fingerprint(c, tolerance)).second) once.push_back(std::move(c));
  }
  if (once.size() < chains.size()) {
    drawing.warnings.push_back(std::to_string(chains.size() - once.size()) +
                               " curves are drawn twice and count once");
  }
  chains = joinEnds(std::move(once), tolerance);
  chains.erase(std::remove_if(chains.begin(), chains.end(), drop), chains.end());
  orientByNesting(chains);
  Index curve = 0;
  for (const Chain& c : chains) {
    CurveMesh mesh = curveThrough(c.points, c.closed);
    ++(c.closed ? drawing.loops : drawing.open);
    const auto first = static_cast<Index>(drawing.curves.points.size());
    drawing.curves.points.insert(drawing.curves.points.end(), mesh.points.begin(),
                                 mesh.points.end());
    for (const auto& [a, b] : mesh.segments)
      drawing.curves.segments.push_back({a + first, b + first});
    drawing.curves.curveOf.resize(drawing.curves.segments.size(), curve++);
  }
  return drawing;
}

std::vector<Vec2> ellipseArc(const Vec2& centre, const Vec2& x, const Vec2& y, double from,
                             double to, double tolerance) {
  // Steps of t on the ellipse are affine images of steps on a circle of the larger radius.
  const double radius = std::sqrt(x.squaredNorm() + y.squaredNorm());
  const double height = std::clamp(tolerance / std::max(radius, 1e-300), 1e-12, 0.3);
  const double step = 2 * std::acos(1 - height);
  const double count = std::ceil(std::abs(to - from) / step);
  const int n = static_cast<int>(std::clamp(count, 1.0, static_cast<double>(kMostArcPoints)));
  std::vector<Vec2> points;
  for (int i = 0; i <= n; ++i) {
    const double t = from + (to - from) * i / n;
    points.emplace_back(centre + std::cos(t) * x + std::sin(t) * y);
  }
  return points;
}

}  // namespace phront::cad
