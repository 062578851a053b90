#include "front/loops_2d.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace phront::facet {

namespace {

struct Side {
  Point2d a;
  Point2d b;
  double minX = 0;
  double maxX = 0;
  double minY = 0;
  double maxY = 0;
  std::size_t loop = 0;
};

double cross(const Point2d& o, const Point2d& a, const Point2d& b) {
  return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

double distanceToSide(const Point2d& p, const Side& s) {
  const double dx = s.b.x - s.a.x;
  const double dy = s.b.y - s.a.y;
  const double length2 = dx * dx + dy * dy;
  double along = 0;
  if (length2 > 0) {
    along = std::clamp(((p.x - s.a.x) * dx + (p.y - s.a.y) * dy) / length2, 0.0, 1.0);
  }
  return std::hypot(p.x - s.a.x - along * dx, p.y - s.a.y - along * dy);
}

bool separate(const Side& s, const Side& t, double clearance) {
  const double d1 = cross(s.a, s.b, t.a);
  const double d2 = cross(s.a, s.b, t.b);
  const double d3 = cross(t.a, t.b, s.a);
  const double d4 = cross(t.a, t.b, s.b);
  if ((d1 > 0) != (d2 > 0) && (d3 > 0) != (d4 > 0)) return false;
  return distanceToSide(t.a, s) >= clearance && distanceToSide(t.b, s) >= clearance &&
         distanceToSide(s.a, t) >= clearance && distanceToSide(s.b, t) >= clearance;
}

/// Sides with a common point: apart but for that point.
bool onlyTouch(const Side& s, const Side& t, double clearance) {
  const Point2d& corner = s.a.id == t.a.id || s.a.id == t.b.id ? s.a : s.b;
  const Point2d& p = s.a.id == corner.id ? s.b : s.a;
  const Point2d& q = t.a.id == corner.id ? t.b : t.a;
  if (p.id == q.id) return false;
  const double ahead = (p.x - corner.x) * (q.x - corner.x) + (p.y - corner.y) * (q.y - corner.y);
  if (ahead <= 0) return true;
  return distanceToSide(p, t) >= clearance && distanceToSide(q, s) >= clearance;
}

bool compatible(const Side& s, const Side& t, double clearance) {
  const bool shared = s.a.id == t.a.id || s.a.id == t.b.id || s.b.id == t.a.id || s.b.id == t.b.id;
  if (!shared) return separate(s, t, clearance);
  return s.loop == t.loop && onlyTouch(s, t, clearance);
}

/// Even-odd test.
bool contains(const Loop2d& loop, const Point2d& p) {
  bool inside = false;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Point2d& a = loop[k];
    const Point2d& b = loop[(k + 1) % loop.size()];
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) {
      inside = !inside;
    }
  }
  return inside;
}

}  // namespace

double signedArea(const Loop2d& loop) {
  double twice = 0;
  for (std::size_t k = 1; k + 1 < loop.size(); ++k) twice += cross(loop[0], loop[k], loop[k + 1]);
  return twice / 2;
}

bool loopsAreSimple(const std::vector<Loop2d>& loops, double clearance) {
  std::vector<Side> sides;
  for (std::size_t l = 0; l < loops.size(); ++l) {
    const Loop2d& loop = loops[l];
    if (loop.size() < 3) return false;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Point2d& a = loop[k];
      const Point2d& b = loop[(k + 1) % loop.size()];
      sides.push_back({a, b, std::min(a.x, b.x), std::max(a.x, b.x), std::min(a.y, b.y),
                       std::max(a.y, b.y), l});
    }
  }
  std::sort(sides.begin(), sides.end(),
            [](const Side& s, const Side& t) { return s.minX < t.minX; });
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const Side& s = sides[i];
    for (std::size_t j = i + 1; j < sides.size() && sides[j].minX <= s.maxX + clearance; ++j) {
      const Side& t = sides[j];
      if (t.minY > s.maxY + clearance || t.maxY < s.minY - clearance) continue;
      if (!compatible(s, t, clearance)) return false;
    }
  }
  return true;
}

std::optional<std::vector<std::vector<std::size_t>>> nestLoops(const std::vector<Loop2d>& loops) {
  std::vector<std::vector<std::size_t>> groups;
  std::vector<double> areas;
  for (const Loop2d& loop : loops) areas.push_back(signedArea(loop));
  for (std::size_t l = 0; l < loops.size(); ++l) {
    if (areas[l] > 0) groups.push_back({l});
  }
  for (std::size_t l = 0; l < loops.size(); ++l) {
    if (areas[l] > 0) continue;
    std::vector<std::size_t>* best = nullptr;
    double smallest = std::numeric_limits<double>::infinity();
    for (auto& group : groups) {
      const std::size_t outer = group.front();
      if (areas[outer] >= smallest || !contains(loops[outer], loops[l].front())) continue;
      smallest = areas[outer];
      best = &group;
    }
    if (!best) return std::nullopt;
    best->push_back(l);
  }
  return groups;
}

}  // namespace phront::facet
