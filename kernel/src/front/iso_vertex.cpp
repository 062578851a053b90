// Vertices by the tangent planes the field already knows, then by Newton on the branches.
//
// Every corner x of a cell knows its foot c: the level's tangent plane is {c + d n, n}, exact for
// planar faces. Start: minimiser of the planes' quadratic error (Ju, Losasso, Schaefer & Warren
// 2002) by truncated eigenvalues (Lindstrom 2000). Then the different branches of the distance that
// the corners' feet lie on (found by descent over the mesh, LocalFoot) are made |x - c_k(x)| = |d|
// all at once by least-norm Newton steps. Since |phi| is the least of the branches, a solution is
// right if and only if no other foot is nearer: a nearer one joins the set (the cutting plane
// method, Kelley 1960). Corners, pairs (creases) and at last plain projection c + d n are tried in
// that order; a point by bisection on a crossed edge always exists. Weak spots: of more than
// kMaxBranches branches in a cell only the nearest to the level are tried; creases flatter than
// kFlatSame within one face are treated as smooth.
#include "front/iso_vertex.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

namespace phront {

namespace {

// Eigenvalues of the quadric below this share of the largest are flat directions (Lindstrom 2000).
constexpr double kFlatEigenvalue = 0.02;
// How far the start, a corner or crease vertex and a smooth one may leave their cell, in cells.
// A wedge that turns its edge to a face of the cell reaches half a cell into the next.
constexpr double kStartMargin = 0.1;
constexpr double kCreaseMargin = 0.6;
constexpr double kTouch = 1e-6;
constexpr double kInset = 0.02;
constexpr double kSmoothMargin = 0.5;
// Branches whose directions differ by less are one: within a face, where facets of a curved face
// differ without a crease being meant, and across faces.
const double kFlatSame = std::cos(0.2);
const double kFlatOther = std::cos(0.04);
constexpr std::size_t kMaxBranches = 5;
// Accepted |phi - d| in diagonals of the box: a tenth of what isoSurface promises.
constexpr double kTolerance = 1e-10;
constexpr int kNewtonSteps = 12;
constexpr int kProjectSteps = 24;
constexpr int kBisections = 200;
constexpr int kRounds = 8;

}  // namespace

/// What the crossed edges of a site tell.
struct VertexPlacer::Crossings {
  Vec3 lower;                // corner of the cell
  double h = 0;              // its side
  Vec3 mean = Vec3::Zero();  // of the linear crossings
  std::vector<Index> nodes;  // ends of the edges, each once; where the cell has this site only all
                             // corners follow
  std::size_t edgeNodes = 0;
  Crossing edge{};  // the one next to the mean
};

VertexPlacer::VertexPlacer(const SurfaceDistance& surface, const LevelGrid& grid,
                           const IsoTopology& topology, const LocalFoot& local)
    : surface_(surface),
      grid_(grid),
      topology_(topology),
      local_(local),
      radius_(std::abs(grid.level())),
      diagonal_(surface.box().diagonal().norm()),
      tolerance_(kTolerance * diagonal_) {}

/// Where the level crosses an edge: |phi| is the least of the branches, so of the crossings of the
/// two ends' tangent planes the one nearer to the surface counts; exact for two planar faces.
Vec3 VertexPlacer::crossingOn(const Crossing& ends) const {
  const double level = grid_.level();
  const Vec3 from = grid_.positionOf(ends[0]);
  const Vec3 along = grid_.positionOf(ends[1]) - from;
  const double p0 = grid_.nodes()[static_cast<std::size_t>(ends[0])].phi;
  const double p1 = grid_.nodes()[static_cast<std::size_t>(ends[1])].phi;
  const double linear = std::clamp((level - p0) / (p1 - p0), 0.0, 1.0);
  // Outside material (level > 0) phi is the least of the planes, inside the greatest.
  const bool late = (level > 0) == (p1 > p0);
  std::optional<double> plane;
  for (std::size_t k = 0; k < 2; ++k) {
    const GridNode& node = grid_.nodes()[static_cast<std::size_t>(ends[k])];
    if (!(std::abs(node.phi) > tolerance_)) continue;
    const double slope = (grid_.positionOf(ends[k]) - node.foot).dot(along) / node.phi;
    // A plane that the edge does not cross within itself, in the right direction, says nothing.
    if (!(slope * (p1 - p0) > 0)) continue;
    const double t = static_cast<double>(k) + (level - node.phi) / slope;
    if (!(t >= 0 && t <= 1)) continue;
    plane = !plane ? t : (late ? std::max(*plane, t) : std::min(*plane, t));
  }
  return from + plane.value_or(linear) * along;
}

VertexPlacer::Crossings VertexPlacer::crossingsOf(const IsoSite& site) const {
  const GridCell& cell = grid_.cells()[static_cast<std::size_t>(site.cell)];
  Crossings out;
  out.lower = grid_.position(cell.lower);
  out.h = grid_.sideOf(cell);
  const std::span<const Crossing> edges = topology_.crossingsOf(site);
  const auto add = [&](Index node) {
    if (std::ranges::find(out.nodes, node) == out.nodes.end()) out.nodes.push_back(node);
  };
  std::vector<Vec3> points;
  out.nodes.reserve(8);
  points.reserve(edges.size());
  for (const Crossing& edge : edges) {
    points.push_back(crossingOn(edge));
    out.mean += points.back();
    for (const Index node : edge) add(node);
  }
  out.mean /= static_cast<double>(edges.size());
  out.edgeNodes = out.nodes.size();
  // A crease near a corner of the cell may show in that corner's foot only. With several sites in
  // the cell it might be another one's.
  if (site.alone) {
    for (const Index node : cell.node) add(node);
  }
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if ((points[i] - out.mean).squaredNorm() < (points[nearest] - out.mean).squaredNorm()) {
      nearest = i;
    }
  }
  out.edge = edges[nearest];
  return out;
}

namespace {

/// Least squares of n_i . x = n_i . p_i around `mean`, flat directions left at the mean.
Vec3 quadricMinimum(const Eigen::Matrix3d& a, const Vec3& b, const Vec3& mean) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(a);
  const Vec3 rhs = b - a * mean;
  Vec3 x = mean;
  const double largest = eigen.eigenvalues()[2];
  for (int k = 0; k < 3; ++k) {
    const double value = eigen.eigenvalues()[k];
    if (!(value > kFlatEigenvalue * largest)) continue;
    const Vec3 axis = eigen.eigenvectors().col(k);
    x += axis * (axis.dot(rhs) / value);
  }
  return x;
}

Vec3 clampToCell(const Vec3& x, const Vec3& lower, double h, double margin) {
  const Vec3 from = lower - Vec3::Constant(margin * h);
  const Vec3 to = lower + Vec3::Constant((1 + margin) * h);
  return x.cwiseMax(from).cwiseMin(to);
}

/// The point of a line nearest to x that lies in the cell, a little off its faces.
std::optional<Vec3> pointOfLineInCell(const Vec3& x, const Vec3& along, const Vec3& lower,
                                      double h) {
  const Vec3 from = lower + Vec3::Constant(kInset * h);
  const Vec3 to = lower + Vec3::Constant((1 - kInset) * h);
  double first = -std::numeric_limits<double>::infinity();
  double last = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a) {
    const double s0 = (from[a] - x[a]) / along[a];
    const double s1 = (to[a] - x[a]) / along[a];
    if (std::isfinite(s0) && std::isfinite(s1)) {
      first = std::max(first, std::min(s0, s1));
      last = std::min(last, std::max(s0, s1));
    } else if (x[a] < from[a] || x[a] > to[a]) {
      return std::nullopt;
    }
  }
  if (!(first <= last) || !std::isfinite(first) || !std::isfinite(last)) return std::nullopt;
  return x + std::clamp(0.0, first, last) * along;
}

bool inCell(const Vec3& x, const Vec3& lower, double h, double margin) {
  return x.allFinite() && clampToCell(x, lower, h, margin) == x;
}

}  // namespace

IsoVertex VertexPlacer::vertexAt(const Vec3& x, const FootPoint& foot) const {
  IsoVertex vertex;
  vertex.point = x;
  vertex.foot = foot;
  vertex.gradient = surface_.gradient(x, foot);
  vertex.residual = std::abs(foot.phi() - grid_.level());
  return vertex;
}

bool VertexPlacer::walk(Branch& branch, const Vec3& x) const {
  const FootPoint foot = local_.find(x, branch.triangle);
  branch.triangle = foot.triangle;
  branch.foot = foot.point;
  branch.distance = foot.distance;
  branch.feature = surface_.featureOf(foot);
  if (!(foot.distance > 0)) return false;
  branch.direction = (x - foot.point) / foot.distance;
  return true;
}

bool VertexPlacer::distinct(const Branch& a, const Branch& b) const {
  const double cosine = a.direction.dot(b.direction);
  const bool same = surface_.mesh().face(a.triangle) == surface_.mesh().face(b.triangle);
  return cosine < (same ? kFlatSame : kFlatOther);
}

/// The different branches that hold the feet of the site's corners, seen from x.
VertexPlacer::Branches VertexPlacer::gather(const Crossings& crossings, const Vec3& x) const {
  std::vector<Index> seeds;
  seeds.reserve(crossings.nodes.size());
  for (const Index node : crossings.nodes) {
    const Index t = grid_.nodes()[static_cast<std::size_t>(node)].triangle;
    if (std::ranges::find(seeds, t) == seeds.end()) seeds.push_back(t);
  }
  Branches all;
  for (const Index seed : seeds) {
    Branch branch;
    branch.triangle = seed;
    if (walk(branch, x)) all.push_back(branch);
  }
  // The nearest first: where several are one, the nearest decides (|phi| is the least of all).
  std::ranges::stable_sort(all, {}, [](const Branch& b) { return b.distance; });
  Branches out;
  for (const Branch& branch : all) {
    if (out.size() == kMaxBranches) break;
    if (std::ranges::all_of(out, [&](const Branch& b) { return distinct(b, branch); })) {
      out.push_back(branch);
    }
  }
  return out;
}

/// Newton for |x - foot_k(x)| = |d|, all k, by least-norm steps. False when they have no such point
/// near x.
bool VertexPlacer::solveBranches(Branches& branches, double h, Vec3& x) const {
  double last = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kNewtonSteps; ++step) {
    Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 8, 3> jacobian(branches.size(), 3);
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1> rhs(branches.size());
    double worst = 0;
    for (std::size_t k = 0; k < branches.size(); ++k) {
      if (!walk(branches[k], x)) return false;
      const auto row = static_cast<Eigen::Index>(k);
      jacobian.row(row) = branches[k].direction.transpose();
      rhs[row] = radius_ - branches[k].distance;
      worst = std::max(worst, std::abs(rhs[row]));
    }
    if (worst <= 1e-3 * tolerance_) return true;
    // Newton at the limit of round-off gains nothing more.
    if (step > 3 && worst > 0.5 * last) return worst <= 0.5 * tolerance_;
    last = worst;
    const Eigen::Matrix3d normal = jacobian.transpose() * jacobian;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(normal);
    const Vec3 gradient = jacobian.transpose() * rhs;
    Vec3 dx = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      const double value = eigen.eigenvalues()[k];
      if (!(value > 1e-6 * eigen.eigenvalues()[2])) continue;  // directions within 1e-3 rad
      const Vec3 axis = eigen.eigenvectors().col(k);
      dx += axis * (axis.dot(gradient) / value);
    }
    const double length = dx.norm();
    if (!(length < 4 * h)) return false;
    x += dx;
  }
  return last <= 0.5 * tolerance_;
}

/// In the cell, or near it in one that the level passes without a vertex of its own.
bool VertexPlacer::reachable(const Vec3& x, const Crossings& crossings) const {
  if (inCell(x, crossings.lower, crossings.h, kTouch)) return true;
  return inCell(x, crossings.lower, crossings.h, kCreaseMargin) && !grid_.crossedAt(x);
}

/// Solves for a set of branches, takes in nearer feet, and accepts by phi itself.
bool VertexPlacer::tryCrease(Branches branches, const Vec3& start, const Crossings& crossings,
                             IsoVertex& vertex) const {
  Vec3 x = start;
  for (int round = 0; round < kRounds; ++round) {
    if (!solveBranches(branches, crossings.h, x)) return false;
    if (!reachable(x, crossings)) {
      // The crease may still cut the cell, elsewhere: along its tangent, else by alternating
      // between both (von Neumann 1949).
      std::optional<Vec3> inside;
      if (branches.size() == 2) {
        const Vec3 along = branches[0].direction.cross(branches[1].direction);
        inside = pointOfLineInCell(x, along, crossings.lower, crossings.h);
      }
      x = inside ? *inside : clampToCell(x, crossings.lower, crossings.h, -kInset);
      continue;
    }
    const FootPoint foot = surface_.footFrom(x, branches.front().triangle);
    if (std::abs(foot.phi() - grid_.level()) <= tolerance_) {
      vertex = vertexAt(x, foot);
      vertex.crease = true;
      return true;
    }
    if (foot.distance > radius_) return false;  // the wrong side of the surface
    Branch nearer;
    nearer.triangle = foot.triangle;
    if (!walk(nearer, x)) return false;
    const auto same =
        std::ranges::find_if(branches, [&](const Branch& b) { return !distinct(b, nearer); });
    if (same != branches.end()) {
      *same = nearer;
    } else if (branches.size() < 3) {
      branches.push_back(nearer);
    } else {
      return false;
    }
  }
  return false;
}

bool VertexPlacer::creaseVertex(const Branches& branches, const Crossings& crossings,
                                IsoVertex& vertex) const {
  if (branches.size() > 2 && tryCrease(branches, crossings.mean, crossings, vertex)) return true;
  if (branches.size() > 3) {
    for (std::size_t i = 0; i < branches.size(); ++i) {
      for (std::size_t j = i + 1; j < branches.size(); ++j) {
        for (std::size_t k = j + 1; k < branches.size(); ++k) {
          const Branches three{branches[i], branches[j], branches[k]};
          if (tryCrease(three, crossings.mean, crossings, vertex)) return true;
        }
      }
    }
  }
  bool found = false;
  for (std::size_t i = 0; i < branches.size(); ++i) {
    for (std::size_t j = i + 1; j < branches.size(); ++j) {
      IsoVertex pair;
      if (!tryCrease({branches[i], branches[j]}, crossings.mean, crossings, pair)) continue;
      const auto off = [&](const IsoVertex& v) { return (v.point - crossings.mean).squaredNorm(); };
      if (!found || off(pair) < off(vertex)) vertex = pair;
      found = true;
    }
  }
  return found;
}

/// x <- foot + d n until phi(x) = d.
bool VertexPlacer::project(Vec3 x, Index hint, const Crossings& crossings,
                           IsoVertex& vertex) const {
  for (int step = 0; step < kProjectSteps; ++step) {
    const FootPoint foot = surface_.footFrom(x, hint);
    if (std::abs(foot.phi() - grid_.level()) <= 1e-3 * tolerance_) {
      vertex = vertexAt(x, foot);
      return true;
    }
    const Vec3 next = foot.point + grid_.level() * surface_.gradient(x, foot);
    if (!inCell(next, crossings.lower, crossings.h, kSmoothMargin)) return false;
    // Round-off may leave more than the strict bound above; then the wide one decides.
    if ((next - x).norm() <= 1e-3 * tolerance_) {
      vertex = vertexAt(x, foot);
      return vertex.residual <= tolerance_;
    }
    x = next;
    hint = foot.triangle;
  }
  return false;
}

/// The crossing itself: phi - d changes sign along the edge.
IsoVertex VertexPlacer::bisect(const Crossings& crossings) const {
  const auto node = [&](Index n) -> const GridNode& {
    return grid_.nodes()[static_cast<std::size_t>(n)];
  };
  Vec3 inside = grid_.positionOf(crossings.edge[0]);
  Vec3 outside = grid_.positionOf(crossings.edge[1]);
  if (!(node(crossings.edge[0]).phi < grid_.level())) std::swap(inside, outside);
  Index hint = node(crossings.edge[0]).triangle;
  IsoVertex best;
  best.residual = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kBisections; ++i) {
    const Vec3 x = 0.5 * (inside + outside);
    const FootPoint foot = surface_.footFrom(x, hint);
    hint = foot.triangle;
    const double residual = std::abs(foot.phi() - grid_.level());
    if (residual < best.residual) best = vertexAt(x, foot);
    if (residual <= 1e-3 * tolerance_ || x == inside || x == outside) break;
    (foot.phi() < grid_.level() ? inside : outside) = x;
  }
  return best;
}

IsoVertex VertexPlacer::placeSafely(const IsoSite& site) const {
  const Crossings crossings = crossingsOf(site);
  const Index hint = grid_.nodes()[static_cast<std::size_t>(crossings.edge[0])].triangle;
  IsoVertex vertex;
  if (project(crossings.mean, hint, crossings, vertex)) return vertex;
  return bisect(crossings);
}

IsoVertex VertexPlacer::place(const IsoSite& site) const {
  const Crossings crossings = crossingsOf(site);
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Vec3 b = Vec3::Zero();
  for (std::size_t i = 0; i < crossings.edgeNodes; ++i) {
    const GridNode& node = grid_.nodes()[static_cast<std::size_t>(crossings.nodes[i])];
    const double distance = std::abs(node.phi);
    if (!(distance > tolerance_)) continue;  // no direction from a point on the surface
    const Vec3 n = (grid_.positionOf(crossings.nodes[i]) - node.foot) / node.phi;
    a += n * n.transpose();
    b += n * n.dot(node.foot + grid_.level() * n);
  }
  Vec3 start =
      clampToCell(quadricMinimum(a, b, crossings.mean), crossings.lower, crossings.h, kStartMargin);
  IsoVertex vertex;
  // Feet give no directions on the surface itself; the quadric has found its creases.
  if (radius_ > tolerance_) {
    const Branches branches = gather(crossings, start);
    if (branches.size() > 1) {
      if (creaseVertex(branches, crossings, vertex)) return vertex;
      start = crossings.mean;  // the quadric sits on a crease that is another cell's
    }
  }
  const Index hint = grid_.nodes()[static_cast<std::size_t>(crossings.edge[0])].triangle;
  if (project(start, hint, crossings, vertex)) return vertex;
  if (project(crossings.mean, hint, crossings, vertex)) return vertex;
  return bisect(crossings);
}

}  // namespace phront
