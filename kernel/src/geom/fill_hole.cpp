#include "phront/fill_hole.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>

namespace phront {
namespace {

constexpr std::size_t kMostCorners = 600;
constexpr int kRounds = 12;
constexpr int kFlipPasses = 4;
constexpr int kSmoothings = 2;
constexpr double kNoFold = 0.2;       // cosine between normals before and after a change
constexpr double kThin = 1e-3;        // area to the squares of the sides: below, a needle
constexpr double kThinPenalty = 1e3;  // times the polygon's extent squared

using Triangle = std::array<Index, 3>;
using Polygon = std::vector<Index>;

Vec3 areaNormal(const Vec3& a, const Vec3& b, const Vec3& c) { return 0.5 * (b - a).cross(c - a); }

bool isNeedle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double sides = (a - b).squaredNorm() + (b - c).squaredNorm() + (c - a).squaredNorm();
  return !(areaNormal(a, b, c).norm() > kThin * sides);
}

/// Loops of one hole as a single polygon: each is joined to the nearest one by a side that is used
/// in both directions.
Polygon joined(const std::vector<Polygon>& loops, const std::vector<Vec3>& points) {
  Polygon polygon = loops.front();
  std::vector<std::size_t> left(loops.size() - 1);
  std::iota(left.begin(), left.end(), 1);
  while (!left.empty()) {
    double nearest = std::numeric_limits<double>::infinity();
    std::size_t chosen = 0;
    std::size_t from = 0;
    std::size_t to = 0;
    for (std::size_t k = 0; k < left.size(); ++k) {
      const Polygon& loop = loops[left[k]];
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        for (std::size_t j = 0; j < loop.size(); ++j) {
          const double d = (points[static_cast<std::size_t>(polygon[i])] -
                            points[static_cast<std::size_t>(loop[j])])
                               .squaredNorm();
          if (d < nearest) {
            nearest = d;
            chosen = k;
            from = i;
            to = j;
          }
        }
      }
    }
    const Polygon& loop = loops[left[chosen]];
    Polygon both(polygon.begin(), polygon.begin() + static_cast<std::ptrdiff_t>(from) + 1);
    for (std::size_t j = 0; j <= loop.size(); ++j) both.push_back(loop[(to + j) % loop.size()]);
    both.insert(both.end(), polygon.begin() + static_cast<std::ptrdiff_t>(from), polygon.end());
    polygon = std::move(both);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(chosen));
  }
  return polygon;
}

/// The patch while it is made finer.
class Patch {
 public:
  Patch(std::vector<Vec3> points, std::vector<Triangle> triangles, const ToSurface& toSurface,
        const FillOptions& options)
      : points_(std::move(points)),
        fixed_(points_.size()),
        triangles_(std::move(triangles)),
        toSurface_(toSurface),
        options_(options) {}

  HoleFill run() {
    flip();
    for (int round = 0; round < kRounds; ++round) {
      if (!divide()) break;
      flip();
      for (int k = 0; k < kSmoothings; ++k) smooth();
      flip();
    }
    HoleFill fill{std::move(points_), std::move(triangles_), 0};
    points_ = fill.points;
    for (const Triangle& t : fill.triangles) fill.deviation = std::max(fill.deviation, off(t));
    return fill;
  }

 private:
  using Side = std::pair<Index, Index>;  // smaller, larger
  struct Users {
    std::array<Index, 2> triangle{kNone, kNone};
    int count = 0;
  };

  [[nodiscard]] const Vec3& at(Index p) const { return points_[static_cast<std::size_t>(p)]; }
  [[nodiscard]] bool isNeedle(const Triangle& t) const {
    return phront::isNeedle(at(t[0]), at(t[1]), at(t[2]));
  }
  [[nodiscard]] Vec3 normalOf(const Triangle& t) const {
    return areaNormal(at(t[0]), at(t[1]), at(t[2]));
  }
  [[nodiscard]] Vec3 middleOf(const Triangle& t) const {
    return (at(t[0]) + at(t[1]) + at(t[2])) / 3;
  }
  [[nodiscard]] double off(const Vec3& x) const {
    const std::optional<Vec3> there = toSurface_(x);
    return there ? (*there - x).norm() : 0;
  }
  [[nodiscard]] double off(const Triangle& t) const {
    double most = off(middleOf(t));
    for (std::size_t k = 0; k < 3; ++k)
      most = std::max(most, off(0.5 * (at(t[k]) + at(t[(k + 1) % 3]))));
    return most;
  }

  [[nodiscard]] std::map<Side, Users> sides() const {
    std::map<Side, Users> result;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Index a = triangles_[t][k];
        const Index b = triangles_[t][(k + 1) % 3];
        Users& users = result[{std::min(a, b), std::max(a, b)}];
        if (users.count < 2)
          users.triangle[static_cast<std::size_t>(users.count)] = static_cast<Index>(t);
        ++users.count;
      }
    }
    return result;
  }

  /// The corner of a triangle that is not on a side.
  static Index apex(const Triangle& t, const Side& side) {
    for (const Index p : t)
      if (p != side.first && p != side.second) return p;
    return kNone;
  }
  /// t with `from` replaced.
  static Triangle replaced(Triangle t, Index from, Index to) {
    std::replace(t.begin(), t.end(), from, to);
    return t;
  }

  Index add(const Vec3& x) {
    points_.push_back(toSurface_(x).value_or(x));
    return static_cast<Index>(points_.size() - 1);
  }

  /// Sides that are long or off the surface, then triangles; each triangle once. False when there
  /// is nothing to divide or no room.
  bool divide() {
    if (static_cast<Index>(triangles_.size()) > options_.maxTriangles) return false;
    struct Wanted {
      double length;
      Side side;
      Users users;
    };
    std::vector<Wanted> wanted;
    for (const auto& [side, users] : sides()) {
      if (users.count != 2) continue;
      const double length = (at(side.first) - at(side.second)).norm();
      if (length > options_.longestSide ||
          off(0.5 * (at(side.first) + at(side.second))) > options_.tolerance)
        wanted.push_back({length, side, users});
    }
    std::stable_sort(wanted.begin(), wanted.end(),
                     [](const Wanted& a, const Wanted& b) { return a.length > b.length; });
    std::vector<char> done(triangles_.size(), 0);
    bool any = false;
    for (const Wanted& w : wanted) {
      const auto [s, t] = w.users.triangle;
      char& doneS = done[static_cast<std::size_t>(s)];
      char& doneT = done[static_cast<std::size_t>(t)];
      if (doneS || doneT) continue;
      doneS = doneT = 1;
      const Index m = add(0.5 * (at(w.side.first) + at(w.side.second)));
      const auto spoilt = [&](Index old) {
        const Triangle& here = triangles_[static_cast<std::size_t>(old)];
        return isNeedle(replaced(here, w.side.first, m)) ||
               isNeedle(replaced(here, w.side.second, m));
      };
      if (spoilt(s) || spoilt(t)) {
        points_.pop_back();
        continue;
      }
      any = true;
      for (const Index old : {s, t}) {
        Triangle& here = triangles_[static_cast<std::size_t>(old)];
        const Triangle before = here;
        here = replaced(before, w.side.first, m);
        triangles_.push_back(replaced(before, w.side.second, m));
      }
    }
    const std::size_t count = done.size();
    for (std::size_t t = 0; t < count; ++t) {
      if (done[t]) continue;
      const Triangle before = triangles_[t];
      if (off(middleOf(before)) <= options_.tolerance) continue;
      const Index m = add(middleOf(before));
      const std::array<Triangle, 3> parts{Triangle{before[0], before[1], m},
                                          Triangle{before[1], before[2], m},
                                          Triangle{before[2], before[0], m}};
      if (std::any_of(parts.begin(), parts.end(),
                      [this](const Triangle& part) { return isNeedle(part); })) {
        points_.pop_back();
        continue;
      }
      any = true;
      triangles_[t] = parts[0];
      triangles_.insert(triangles_.end(), parts.begin() + 1, parts.end());
    }
    return any;
  }

  /// Towards Delaunay: a side goes where the two angles opposite to it are together more than pi.
  void flip() {
    for (int pass = 0; pass < kFlipPasses; ++pass) {
      bool any = false;
      std::map<Side, Users> all = sides();
      std::vector<char> done(triangles_.size(), 0);
      for (const auto& [side, users] : all) {
        if (users.count != 2) continue;
        const auto s = static_cast<std::size_t>(users.triangle[0]);
        const auto t = static_cast<std::size_t>(users.triangle[1]);
        if (done[s] || done[t]) continue;
        const Index c = apex(triangles_[s], side);
        const Index d = apex(triangles_[t], side);
        if (c == kNone || d == kNone || c == d || all.contains({std::min(c, d), std::max(c, d)}))
          continue;
        if (angleAt(c, side) + angleAt(d, side) <= std::numbers::pi + 1e-9) continue;
        const Triangle first = replaced(triangles_[s], side.first, d);
        const Triangle second = replaced(triangles_[t], side.second, c);
        const Vec3 before = normalOf(triangles_[s]) + normalOf(triangles_[t]);
        if (!agrees(first, before) || !agrees(second, before)) continue;
        if (isNeedle(first) || isNeedle(second)) continue;
        triangles_[s] = first;
        triangles_[t] = second;
        done[s] = done[t] = 1;
        any = true;
        all[{std::min(c, d), std::max(c, d)}] = {};
      }
      if (!any) return;
    }
  }
  [[nodiscard]] double angleAt(Index p, const Side& side) const {
    const Vec3 a = at(side.first) - at(p);
    const Vec3 b = at(side.second) - at(p);
    return std::atan2(a.cross(b).norm(), a.dot(b));
  }
  [[nodiscard]] bool agrees(const Triangle& t, const Vec3& normal) const {
    const Vec3 n = normalOf(t);
    return n.dot(normal) > kNoFold * n.norm() * normal.norm();
  }

  /// Points inside go half the way to the middle of their neighbours, and back to the surface,
  /// where no triangle turns over.
  void smooth() {
    std::vector<std::vector<Index>> around(points_.size());
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      for (const Index p : triangles_[t])
        around[static_cast<std::size_t>(p)].push_back(static_cast<Index>(t));
    for (std::size_t p = fixed_; p < points_.size(); ++p) {
      Vec3 sum = Vec3::Zero();
      int count = 0;
      std::vector<Vec3> normals;
      for (const Index t : around[p]) {
        const Triangle& triangle = triangles_[static_cast<std::size_t>(t)];
        normals.push_back(normalOf(triangle));
        for (const Index q : triangle) {
          if (q == static_cast<Index>(p)) continue;
          sum += at(q);
          ++count;
        }
      }
      if (count == 0) continue;
      const Vec3 before = points_[p];
      const std::optional<Vec3> there = toSurface_(0.5 * (before + sum / count));
      if (!there) continue;
      points_[p] = *there;
      for (std::size_t k = 0; k < around[p].size(); ++k) {
        const Triangle& triangle = triangles_[static_cast<std::size_t>(around[p][k])];
        if (agrees(triangle, normals[k]) && !isNeedle(triangle)) continue;
        points_[p] = before;
        break;
      }
    }
  }

  std::vector<Vec3> points_;
  std::size_t fixed_;
  std::vector<Triangle> triangles_;
  const ToSurface& toSurface_;
  const FillOptions& options_;
};

}  // namespace

std::vector<Triangle> leastAreaTriangles(const Polygon& polygon, const std::vector<Vec3>& points,
                                         Needles needles) {
  const std::size_t n = polygon.size();
  const auto at = [&](std::size_t i) { return points[static_cast<std::size_t>(polygon[i])]; };
  Box3 box;
  for (std::size_t i = 0; i < n; ++i) box.extend(at(i));
  const double penalty = kThinPenalty * box.diagonal().squaredNorm();
  const auto cost = [&](std::size_t i, std::size_t j, std::size_t k) {
    if (polygon[i] == polygon[j] || polygon[j] == polygon[k] || polygon[i] == polygon[k])
      return std::numeric_limits<double>::infinity();
    const double area = areaNormal(at(i), at(j), at(k)).norm();
    return needles == Needles::Avoided && isNeedle(at(i), at(j), at(k)) ? penalty : area;
  };
  std::vector<double> best(n * n, 0);
  std::vector<std::size_t> middle(n * n, 0);
  for (std::size_t span = 2; span < n; ++span) {
    for (std::size_t i = 0; i + span < n; ++i) {
      const std::size_t k = i + span;
      double least = std::numeric_limits<double>::infinity();
      middle[i * n + k] = i + 1;
      for (std::size_t j = i + 1; j < k; ++j) {
        const double rest = best[i * n + j] + best[j * n + k];
        if (rest >= least) continue;
        const double sum = rest + cost(i, j, k);
        if (sum < least) {
          least = sum;
          middle[i * n + k] = j;
        }
      }
      best[i * n + k] = least;
    }
  }
  if (n < 3 || !std::isfinite(best[n - 1])) return {};
  std::vector<Triangle> triangles;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, n - 1}};
  while (!open.empty()) {
    const auto [i, k] = open.back();
    open.pop_back();
    if (k < i + 2) continue;
    const std::size_t j = middle[i * n + k];
    triangles.push_back({polygon[i], polygon[j], polygon[k]});
    open.emplace_back(i, j);
    open.emplace_back(j, k);
  }
  return triangles;
}

Result<HoleFill> fillHole(const std::vector<std::vector<Vec3>>& loops, const ToSurface& toSurface,
                          const FillOptions& options) {
  if (!(options.tolerance > 0) || !(options.longestSide > 0) || options.maxTriangles < 1)
    return fail(ErrorCode::InvalidArgument,
                "The tolerance, the longest side and the number of triangles of a hole's patch "
                "must be greater than 0.");
  std::vector<Vec3> points;
  std::vector<Polygon> polygons;
  for (const std::vector<Vec3>& loop : loops) {
    if (loop.size() < 3)
      return fail(ErrorCode::InvalidArgument, "A loop of a hole has fewer than three corners.");
    Polygon polygon;
    for (const Vec3& p : loop) {
      if (!p.allFinite())
        return fail(ErrorCode::InvalidArgument, "A corner of a hole is not a number.");
      polygon.push_back(static_cast<Index>(points.size()));
      points.push_back(p);
    }
    polygons.push_back(std::move(polygon));
  }
  if (polygons.empty()) return fail(ErrorCode::InvalidArgument, "A hole needs a loop.");
  if (points.size() > kMostCorners)
    return fail(ErrorCode::ResourceLimit,
                fmt::format("A hole has {} corners, more than the {} that its least area can be "
                            "found for.",
                            points.size(), kMostCorners));
  std::vector<Triangle> triangles =
      leastAreaTriangles(joined(polygons, points), points, Needles::Avoided);
  if (triangles.empty())
    return fail(ErrorCode::Failed, "The corners of a hole have no triangles over them.");
  return Patch(std::move(points), std::move(triangles), toSurface, options).run();
}

}  // namespace phront
