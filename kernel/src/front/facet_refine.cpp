// Splitting of sides that cut through phi = d: the iso-surface may be coarser than the tolerance.
//
// Longest sides first, each split at its middle, which is then projected onto phi = d along the
// gradient. Splitting a side splits both its triangles, so the mesh stays closed.
// A side that runs from one sheet to another cuts their crease off: it is split on the crease,
// where the tangent planes of both sheets meet (as dual contouring does, Ju et al. 2002). Weak
// spot: between nearly tangent sheets, or where three meet, the middle lands on one of them; the
// next splits close in on the crease.
#include <algorithm>
#include <cmath>
#include <queue>
#include <set>
#include <tuple>

#include "front/facet_mesh.h"

namespace phront::facet {

namespace {

// Newton steps along the gradient of a distance land in one step where the surface is smooth.
constexpr int kProjectionSteps = 4;
// A projected middle may move by this part of its side: farther is another sheet.
constexpr double kLargestMove = 0.3;
// Sheets whose normals differ by less than 14 degrees have no crease worth finding.
constexpr double kSharp = 0.97;
constexpr int kCreaseSteps = 3;
// Tangent planes are taken this part of the way from the crease to either end.
constexpr double kProbe = 0.5;
// A crease may run this part of the side away from its middle.
constexpr double kLargestCreaseMove = 0.6;
// Splitting round and round one point is a crease that splits cannot find, not a curved surface.
constexpr std::size_t kMaxSpokes = 64;
// A projected middle stays this part of its side away from the corners around.
constexpr double kTooNear = 0.15;
// A projected middle has landed when it misses phi = d by no more than this share of the tolerance.
constexpr double kLanded = 0.1;
// The same of one where sheets change, the part of the side that is searched to either end for the
// change, and how often and how well.
constexpr double kChangeLanded = 0.5;
constexpr double kLargestChangeMove = 1.5;
constexpr double kChangeReach = 0.4;
constexpr int kChangeSteps = 3;
constexpr int kBisections = 10;
// A side is turned where that takes away this share of its deviation.
constexpr double kWorthTurning = 0.3;
// Cosine of the largest angle between a turned triangle and grad phi.
constexpr double kFacing = 0.3;

struct Side {
  double length = 0;
  Index from = kNone;
  Index to = kNone;
  friend bool operator<(const Side& a, const Side& b) {
    return std::tie(a.length, b.from, b.to) < std::tie(b.length, a.from, a.to);
  }
};

/// Middle of a side moved onto phi = d; empty when that leads astray.
std::optional<Vec3> projectedMiddle(const WorkMesh& mesh, const Context& context, const Side& side,
                                    Index hint, double tolerance) {
  const Vec3 middle = 0.5 * (mesh.points[side.from] + mesh.points[side.to]);
  Vec3 x = middle;
  for (int step = 0; step < kProjectionSteps; ++step) {
    const FootPoint foot =
        hint == kNone ? context.surface.foot(x) : context.surface.footFrom(x, hint);
    x += (context.level - foot.phi()) * context.surface.gradient(x, foot);
    hint = foot.triangle;
  }
  if (!x.allFinite() || (x - middle).norm() > kLargestMove * side.length) return std::nullopt;
  if (measure(context, x, hint).deviation > kLanded * tolerance) return std::nullopt;
  return x;
}

/// Where a side crosses a crease: the point nearest to its middle that lies in the tangent planes
/// on either side, followed along curved sheets. Empty when the side crosses none.
std::optional<Vec3> creasePoint(const WorkMesh& mesh, const Context& context, const Side& side,
                                Index hint, double tolerance) {
  const Vec3& a = mesh.points[side.from];
  const Vec3& b = mesh.points[side.to];
  const Vec3 middle = 0.5 * (a + b);
  Vec3 x = middle;
  for (int step = 0; step < kCreaseSteps; ++step) {
    Eigen::Matrix<double, 2, 3> normals;
    Eigen::Vector2d gap;
    for (const int end : {0, 1}) {
      const Vec3 probe = x + kProbe * ((end == 0 ? a : b) - x);
      const FootPoint foot = context.surface.footFrom(probe, hint);
      const Vec3 gradient = context.surface.gradient(probe, foot);
      normals.row(end) = gradient;
      gap[end] = context.level - foot.phi() - gradient.dot(x - probe);
    }
    const double cosine = normals.row(0).dot(normals.row(1));
    if (!(std::abs(cosine) < kSharp)) return std::nullopt;
    const Eigen::Vector2d weights =
        Eigen::Vector2d(gap[0] - cosine * gap[1], gap[1] - cosine * gap[0]) / (1 - cosine * cosine);
    x += normals.transpose() * weights;
  }
  if (!x.allFinite() || (x - middle).norm() > kLargestCreaseMove * side.length) return std::nullopt;
  if (measure(context, x, hint).deviation > kLanded * tolerance) return std::nullopt;
  return x;
}

/// creasePoint() where more than two sheets are near: the tangent planes are taken right before and
/// behind the place where the foot changes sheets, which is found by bisection.
std::optional<Vec3> changePoint(const WorkMesh& mesh, const Context& context, const Side& side,
                                Index hint, double tolerance) {
  const Vec3 along = mesh.points[side.to] - mesh.points[side.from];
  const Vec3 middle = 0.5 * (mesh.points[side.from] + mesh.points[side.to]);
  struct Probe {
    Vec3 x, gradient;
    double gap;
  };
  const auto probe = [&](const Vec3& x) {
    const FootPoint foot = context.surface.footFrom(x, hint);
    return Probe{x, context.surface.gradient(x, foot), context.level - foot.phi()};
  };
  Vec3 x = middle;
  for (int step = 0; step < kChangeSteps; ++step) {
    Probe a = probe(x - kChangeReach * along);
    Probe b = probe(x + kChangeReach * along);
    if (!(a.gradient.dot(b.gradient) < kSharp)) return std::nullopt;
    for (int k = 0; k < kBisections; ++k) {
      const Probe m = probe(0.5 * (a.x + b.x));
      (m.gradient.dot(a.gradient) > m.gradient.dot(b.gradient) ? a : b) = m;
    }
    const double cosine = a.gradient.dot(b.gradient);
    if (!(std::abs(cosine) < kSharp)) return std::nullopt;
    const double gapA = a.gap - a.gradient.dot(x - a.x);
    const double gapB = b.gap - b.gradient.dot(x - b.x);
    x += (a.gradient * (gapA - cosine * gapB) + b.gradient * (gapB - cosine * gapA)) /
         (1 - cosine * cosine);
    if (!x.allFinite() || (x - middle).norm() > kLargestChangeMove * side.length)
      return std::nullopt;
  }
  if (measure(context, x, hint).deviation > kChangeLanded * tolerance) return std::nullopt;
  return x;
}

/// True when x lies nearer than `distance` to a corner of the triangles: beside a crease middles of
/// several sides land on one point, and coincident points are poison downstream.
bool nearCorner(const WorkMesh& mesh, const std::vector<Index>& triangles, const Vec3& x,
                double distance) {
  for (const Index t : triangles)
    for (int k = 0; k < 3; ++k)
      if ((mesh.point(t, k) - x).norm() < distance) return true;
  return false;
}

/// Replaces corner `from` of triangle t by p and lets a new triangle take the other half.
Index splitTriangle(WorkMesh& mesh, Index t, Index from, Index to, Index p) {
  const Index half = mesh.triangleCount();
  mesh.corners.push_back(mesh.corners[t]);
  mesh.label.push_back(mesh.label[t]);
  mesh.plane.push_back(mesh.plane[t]);
  mesh.hint.push_back(mesh.hint[t]);
  mesh.tangent.push_back(mesh.tangent[t]);
  mesh.corners[t][mesh.cornerOf(t, from)] = p;
  mesh.corners[half][mesh.cornerOf(half, to)] = p;
  std::erase(mesh.around[from], t);
  for (const Index q : mesh.corners[half]) mesh.around[q].push_back(half);
  mesh.around[p].push_back(t);
  return half;
}

/// The other diagonal of the two triangles at a side in its place, where it is nearer to phi = d:
/// the corner that a split would make may be there already. False where it is not, or a triangle
/// would turn over.
bool turn(WorkMesh& mesh, const Context& context, const std::vector<Index>& both, const Side& side,
          const Measured& middle) {
  const auto apex = [&](Index t) {
    for (const Index p : mesh.corners[t])
      if (p != side.from && p != side.to) return p;
    return kNone;
  };
  const bool runsAlong =
      mesh.corners[both[0]][(mesh.cornerOf(both[0], side.from) + 1) % 3] == side.to;
  const Index first = runsAlong ? both[0] : both[1];  // holds from -> to
  const Index second = runsAlong ? both[1] : both[0];
  const Index c = apex(first);
  const Index d = apex(second);
  if (c == d) return false;
  for (const Index t : mesh.around[c])
    for (const Index p : mesh.corners[t])
      if (p == d) return false;
  const Vec3& pc = mesh.points[c];
  const Vec3& pd = mesh.points[d];
  if (measure(context, 0.5 * (pc + pd), middle.triangle).deviation >
      (1 - kWorthTurning) * middle.deviation)
    return false;
  const std::array<Corners, 2> after{Corners{side.from, d, c}, Corners{d, side.to, c}};
  for (const Corners& t : after) {
    const Vec3& p = mesh.points[t[0]];
    const Vec3& q = mesh.points[t[1]];
    const Vec3& r = mesh.points[t[2]];
    const Vec3 normal = (q - p).cross(r - p);
    if (smallestHeight(p, q, r) < context.heightFloor) return false;
    const Measured at = measure(context, (p + q + r) / 3, middle.triangle);
    if (normal.dot(at.gradient) < kFacing * normal.norm()) return false;
  }
  std::erase(mesh.around[side.to], first);
  std::erase(mesh.around[side.from], second);
  mesh.corners[first] = after[0];
  mesh.corners[second] = after[1];
  mesh.around[d].push_back(first);
  mesh.around[c].push_back(second);
  for (const Index t : {first, second}) {
    mesh.plane[t] = kNone;
    const Measured at = measure(context, mesh.centroid(t), middle.triangle);
    mesh.hint[t] = at.triangle;
    mesh.tangent[t] = at.gradient;
  }
  return true;
}

}  // namespace

void refine(WorkMesh& mesh, const Context& context, double tolerance, double shortest,
            Index maxTriangles) {
  std::priority_queue<Side> queue;
  std::set<std::pair<Index, Index>> turned;  // each side once, lest two turn for ever
  const auto push = [&](Index a, Index b) {
    if (a > b) std::swap(a, b);
    queue.push({(mesh.points[a] - mesh.points[b]).norm(), a, b});
  };
  for (Index t = 0; t < mesh.triangleCount(); ++t) {
    for (int k = 0; k < 3; ++k) {
      if (mesh.corners[t][k] < mesh.corners[t][(k + 1) % 3]) {
        push(mesh.corners[t][k], mesh.corners[t][(k + 1) % 3]);
      }
    }
  }
  while (!queue.empty() && mesh.triangleCount() < maxTriangles) {
    const Side side = queue.top();
    queue.pop();
    // Between two points of phi = d the middle of such a short side cannot deviate more.
    if (side.length < std::max(shortest, 2 * tolerance)) break;
    if (mesh.around[side.from].size() > kMaxSpokes) continue;
    std::vector<Index> both;
    for (const Index t : mesh.around[side.from]) {
      const Corners& c = mesh.corners[t];
      if (c[0] == side.to || c[1] == side.to || c[2] == side.to) both.push_back(t);
    }
    if (both.size() != 2 || mesh.frozen(both[0]) || mesh.frozen(both[1])) continue;
    if (mesh.plane[both[0]] != kNone && mesh.plane[both[1]] != kNone) continue;
    const Vec3 middle = 0.5 * (mesh.points[side.from] + mesh.points[side.to]);
    const Measured m = measure(context, middle, mesh.hint[both[0]]);
    if (m.deviation <= tolerance) continue;
    auto x = creasePoint(mesh, context, side, m.triangle, tolerance);
    if (!x) x = projectedMiddle(mesh, context, side, m.triangle, tolerance);
    if (!x) x = changePoint(mesh, context, side, m.triangle, tolerance);
    if (!x || nearCorner(mesh, both, *x, kTooNear * side.length)) {
      if (turned.insert({side.from, side.to}).second && turn(mesh, context, both, side, m)) {
        for (const Index t : both)
          for (int k = 0; k < 3; ++k) push(mesh.corners[t][k], mesh.corners[t][(k + 1) % 3]);
      }
      continue;
    }
    const Index p = mesh.pointCount();
    mesh.points.push_back(*x);
    mesh.around.emplace_back();
    mesh.exactPlanes.emplace_back();
    for (const Index t : both) {
      const Index half = splitTriangle(mesh, t, side.from, side.to, p);
      mesh.plane[t] = mesh.plane[half] = kNone;
      for (const Index piece : {t, half}) {
        const Measured at = measure(context, mesh.centroid(piece), m.triangle);
        mesh.hint[piece] = at.triangle;
        mesh.tangent[piece] = at.gradient;
        for (int k = 0; k < 3; ++k) {
          const Index a = mesh.corners[piece][k];
          const Index b = mesh.corners[piece][(k + 1) % 3];
          if (a == p || b == p) push(a, b);
        }
      }
    }
  }
}

}  // namespace phront::facet
