// Edge collapse by quadric error (Garland & Heckbert 1997), points collapsing onto neighbours.
//
// A collapse keeps one of its two ends where it is: points stay on phi = d, on creases and in their
// planes without solving anything. Allowed when
//  - the surface stays a manifold (link condition, Dey et al. 1999),
//  - the planes of the vanishing point hold the kept one too: plane regions stay exact,
//  - no triangle turns over, against its old normal and against grad phi, nor gets needle thin,
//  - phi at the new triangles' centroids and side middles is d within the tolerance,
//  - all points of phi = d that went before and that these triangles stand for (witnesses) stay
//    within the tolerance: the surface is neither cut short nor bridged (Klein et al. 1996).
// Collapses inside a plane change no geometry and measure nothing.
// Weak spot: points on phi = d put all deviation on one side of curved surfaces; points that float
// by half the tolerance would save up to half of the triangles there.
#include "front/facet_collapse.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <tuple>
#include <utility>

namespace phront::facet {

namespace {

// Ties of the quadric error (planes, along cylinders) go to the shorter side; squared, 1e-5 of the
// side counts as much as a deviation.
constexpr double kLengthWeight = 1e-10;
// Largest turn of a triangle against its old normal (78 degrees) and against grad phi (60 degrees).
constexpr double kLargestTurn = 0.2;
constexpr double kAgainstGradient = 0.5;
// Points within this part of the diagonal of a line lie on it.
constexpr double kCollinear = 1e-10;
// Progress is asked for once in so many collapses.
constexpr int kProgressStride = 1024;
// A pass over the changed surroundings again pays as long as it removes this part of the triangles.
constexpr double kWorthwhile = 0.02;
constexpr int kMaxPasses = 4;
// On a curved surface the kept end of a chord lies four times its deviation off the tangent plane
// of the other end; quadric errors beyond twice that are hopeless and not worth measuring.
constexpr double kHopeless = 8;

// Hubs of many spokes make every collapse beside them slow (the work grows with the square), and
// the triangles of a plane are merged to one polygon later anyway.
constexpr std::size_t kMaxSpokes = 48;

bool contains(const std::vector<Index>& sorted, Index value) {
  return std::binary_search(sorted.begin(), sorted.end(), value);
}

}  // namespace

bool Collapser::isLater(const Candidate& a, const Candidate& b) {
  return std::tie(b.cost, b.gone, b.kept) < std::tie(a.cost, a.gone, a.kept);
}

Collapser::Collapser(WorkMesh& mesh, const Context& context) : mesh_(mesh), context_(context) {
  origin_ = context.center;
  quadrics_.resize(mesh.points.size());
  stamps_.assign(mesh.points.size(), 0);
  changed_.assign(mesh.points.size(), 1);
  witnesses_.resize(mesh.corners.size());
  for (Index t = 0; t < mesh.triangleCount(); ++t) {
    if (!mesh.alive(t) || mesh.frozen(t)) continue;
    const double weight = mesh.areaVector(t).norm() / 6;  // a third of the area to each corner
    const bool planar = mesh.plane[t] != kNone;
    const Vec3 normal = planar ? mesh.planes[mesh.plane[t]].normal : mesh.tangent[t];
    for (int k = 0; k < 3; ++k) {
      quadrics_[mesh.corners[t][k]].addPlane(normal, mesh.point(t, k) - origin_, weight);
    }
  }
}

void Collapser::push(Index p, Index q) {
  if (mesh_.fixed(p) || q < mesh_.apexes) return;
  const double weight = quadrics_[p].a.trace();  // traces of n n^T add up to the weight
  const double error = std::max(0.0, quadrics_[p].at(mesh_.points[q] - origin_));
  if (error > weight * std::pow(kHopeless * tolerance_, 2)) return;
  const double length = (mesh_.points[p] - mesh_.points[q]).squaredNorm();
  heap_.push_back({error + kLengthWeight * weight * length, p, q, stamps_[p]});
  std::push_heap(heap_.begin(), heap_.end(), isLater);
}

std::vector<Index> Collapser::neighbours(Index p) const {
  std::vector<Index> result;
  for (const Index t : mesh_.around[p]) {
    const int k = mesh_.cornerOf(t, p);
    result.push_back(mesh_.corners[t][(k + 1) % 3]);
  }
  return result;  // closed manifold: every neighbour follows p in exactly one triangle
}

Result<void> Collapser::run(double tolerance, const Progress& progress) {
  tolerance_ = tolerance;
  changed_.assign(mesh_.points.size(), 1);
  const Index before = mesh_.aliveCount();
  Index left = before;
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    heap_.clear();
    const std::vector<char> again = std::exchange(changed_, std::vector<char>(changed_.size(), 0));
    for (Index p = 0; p < mesh_.pointCount(); ++p) {
      if (!again[p]) continue;
      for (const Index q : neighbours(p)) push(p, q);
    }
    Index gone = 0;
    while (!heap_.empty()) {
      std::pop_heap(heap_.begin(), heap_.end(), isLater);
      const Candidate c = heap_.back();
      heap_.pop_back();
      if (c.stamp != stamps_[c.gone]) continue;
      if (mesh_.around[c.gone].empty() || mesh_.around[c.kept].empty()) continue;
      if (!tryCollapse(c.gone, c.kept)) continue;
      gone += 2;
      if (gone % kProgressStride == 0 && !progress.report(1.0 - double(left - gone) / before)) {
        return fail(ErrorCode::Cancelled, "Facetting was cancelled.");
      }
    }
    left -= gone;
    if (gone < kWorthwhile * left) break;
  }
  return {};
}

bool Collapser::tryCollapse(Index gone, Index kept) {
  if (mesh_.around[gone].size() + mesh_.around[kept].size() > kMaxSpokes) return false;
  const auto& planes = mesh_.exactPlanes[kept];
  fan_.clear();
  lost_.clear();
  found_.clear();
  for (const Index t : mesh_.around[gone]) {
    const Corners& c = mesh_.corners[t];
    const bool holdsBoth = c[0] == kept || c[1] == kept || c[2] == kept;
    (holdsBoth ? lost_ : fan_).push_back(t);
    if (!holdsBoth && mesh_.plane[t] != kNone && !contains(planes, mesh_.plane[t])) return false;
  }
  if (lost_.size() != 2 || !linkAllows(gone, kept) || !shapesAllow(gone, kept)) return false;
  const bool exact = isExact(gone, kept);
  if (!witnessesAllow(gone, kept, !exact)) return false;
  if (!exact && !deviationAllows(gone, kept)) return false;
  apply(gone, kept);
  return true;
}

bool Collapser::linkAllows(Index gone, Index kept) const {
  std::vector<Index> a = neighbours(gone);
  std::vector<Index> b = neighbours(kept);
  if (a.size() == 3 && b.size() == 3) return false;  // a tetrahedron
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  std::vector<Index> common;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
  return common.size() == 2;
}

bool Collapser::shapesAllow(Index gone, Index kept) {
  const Vec3& x = mesh_.points[kept];
  for (const Index t : fan_) {
    const int k = mesh_.cornerOf(t, gone);
    const Vec3& a = mesh_.point(t, (k + 1) % 3);
    const Vec3& b = mesh_.point(t, (k + 2) % 3);
    const double height = smallestHeight(x, a, b);
    if (height < context_.heightFloor && height <= smallestHeight(mesh_.points[gone], a, b)) {
      return false;
    }
    const Vec3 after = (a - x).cross(b - x);
    if (mesh_.plane[t] != kNone) {
      if (after.dot(mesh_.planes[mesh_.plane[t]].normal) <= 0) return false;
    } else {
      const Vec3 before = mesh_.areaVector(t);
      const bool thin = smallestHeight(mesh_.points[gone], a, b) < context_.heightFloor;
      if (!thin && after.dot(before) < kLargestTurn * after.norm() * before.norm()) return false;
    }
  }
  return true;
}

/// True when the collapse leaves every point of the surface where it is.
bool Collapser::isExact(Index gone, Index kept) const {
  const auto& planes = mesh_.exactPlanes[gone];
  if (planes.empty() || planes.size() > 2) return false;
  for (const Index t : mesh_.around[gone]) {
    if (mesh_.plane[t] == kNone) return false;
  }
  if (planes.size() == 1) return true;
  // On the line of two planes: kept must lie on it, and so must the border's other neighbour.
  const Vec3 axis = (mesh_.planes[planes[0]].normal).cross(mesh_.planes[planes[1]].normal);
  const Vec3 direction = axis.normalized();
  for (const Index q : neighbours(gone)) {
    const auto& at = mesh_.exactPlanes[q];
    if (!contains(at, planes[0]) || !contains(at, planes[1])) continue;
    const Vec3 side = mesh_.points[q] - mesh_.points[gone];
    if ((side - direction * direction.dot(side)).norm() > kCollinear * context_.diagonal) {
      return false;
    }
  }
  return contains(mesh_.exactPlanes[kept], planes[0]) &&
         contains(mesh_.exactPlanes[kept], planes[1]);
}

bool Collapser::deviationAllows(Index gone, Index kept) {
  const Vec3& x = mesh_.points[kept];
  found_.assign(fan_.size(), {});
  for (std::size_t i = 0; i < fan_.size(); ++i) {
    const Index t = fan_[i];
    const int k = mesh_.cornerOf(t, gone);
    const Vec3& a = mesh_.point(t, (k + 1) % 3);
    const Vec3& b = mesh_.point(t, (k + 2) % 3);
    found_[i] = measure(context_, (x + a + b) / 3.0, mesh_.hint[t]);
    if (found_[i].deviation > tolerance_) return false;
    const Vec3 normal = (a - x).cross(b - x);
    const double agreement = normal.dot(found_[i].gradient);
    if (agreement < kAgainstGradient * normal.norm()) {
      // Triangles that were wrong before may stay so on their way out.
      const Vec3 before = mesh_.areaVector(t);
      if (before.dot(mesh_.tangent[t]) >= kAgainstGradient * before.norm()) return false;
    }
    if (measure(context_, 0.5 * (x + a), found_[i].triangle).deviation > tolerance_) return false;
  }
  return true;
}

bool Collapser::witnessesAllow(Index gone, Index kept, bool addGone) {
  const Vec3& x = mesh_.points[kept];
  moved_.resize(std::max(moved_.size(), fan_.size()));
  for (std::size_t i = 0; i < fan_.size(); ++i) moved_[i].clear();
  const auto place = [&](Index w) {
    double best = std::numeric_limits<double>::infinity();
    std::size_t where = 0;
    for (std::size_t i = 0; i < fan_.size() && best > 0; ++i) {
      const int k = mesh_.cornerOf(fan_[i], gone);
      const double distance = distanceToTriangle(
          mesh_.points[w], x, mesh_.point(fan_[i], (k + 1) % 3), mesh_.point(fan_[i], (k + 2) % 3));
      if (distance < best) {
        best = distance;
        where = i;
      }
    }
    if (best > tolerance_) return false;
    moved_[where].push_back(w);
    return true;
  };
  for (const Index t : mesh_.around[gone]) {
    for (const Index w : witnesses_[t]) {
      if (!place(w)) return false;
    }
  }
  return !addGone || place(gone);
}

void Collapser::apply(Index gone, Index kept) {
  for (const Index t : lost_) {
    for (const Index p : mesh_.corners[t]) {
      if (p != gone) std::erase(mesh_.around[p], t);
    }
    mesh_.corners[t] = {kNone, kNone, kNone};
    witnesses_[t].clear();
  }
  for (std::size_t i = 0; i < fan_.size(); ++i) {
    const Index t = fan_[i];
    mesh_.corners[t][mesh_.cornerOf(t, gone)] = kept;
    mesh_.around[kept].push_back(t);
    witnesses_[t].swap(moved_[i]);
    if (i < found_.size() && found_[i].triangle != kNone) {
      mesh_.hint[t] = found_[i].triangle;
      mesh_.tangent[t] = found_[i].gradient;
    }
  }
  mesh_.around[gone].clear();
  quadrics_[kept].add(quadrics_[gone]);
  ++stamps_[kept];
  changed_[kept] = 1;
  for (const Index q : neighbours(kept)) {
    changed_[q] = 1;
    push(kept, q);
    push(q, kept);
  }
}

}  // namespace phront::facet
