// Advection of points with the exact gradient.
//
// Off the medial axis the characteristics of |grad phi| = 1 are straight: a point of the surface
// moves along its normal and its foot stays where it started (Sethian, "Level Set Methods and Fast
// Marching Methods", 1999). It has met another front when something is nearer than its own start.
// That loss, (distance walked) - (distance to the surface), is zero before the medial axis and
// never shrinks behind it, as phi is 1-Lipschitz; so the axis is found by bisection, with exact
// distances. In a corner that the front shrinks into (a box inwards) |phi| grows at a smaller rate
// from the start; nodes of the mesh walk on at that rate, which ends in the mitre of planes. On a
// tessellated curved face the nearest facet is not exactly the start's: a loss that the turn of the
// normals around the start explains is forgiven while the foot lies on facets that continue the
// start's smoothly. Weak spots: an edge that turns by less than kSmoothTurn counts as tessellation,
// and its fronts pass one another; curved walls that fillets join to the wall they meet miss the
// medial axis by what is forgiven.
#include "phront/advect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "geom/closest_on_triangle.h"
#include "geom/mesh_topology.h"

namespace phront {

namespace {

constexpr double kBisection = 1e-12;     // of the way: the promise of the header
constexpr double kForgivenShare = 0.01;  // of a forgiven loss: locating it better tells nothing
constexpr double kRoundOff = 32;     // ulps of the largest coordinate: a foot, a step, a difference
constexpr double kSmoothTurn = 0.4;  // rad: tessellations turn by 0.35 at most between facets
const double kSmoothBend = 1 - std::cos(kSmoothTurn);
constexpr double kTessellationLoss = 2;  // facets elsewhere may be twice as coarse as at the start
constexpr double kProbe = 1e-3;          // of the distance: where a corner's rate is measured
constexpr double kLeastRate = 0.05;      // below, the node could walk 20 times the distance
constexpr int kNewtonSteps = 3;          // phi is linear along the path but for facets
constexpr std::int64_t kGrain = 256;     // points per task: about 1 ms
constexpr std::int64_t kReports = 50;    // chunks between two looks at the progress handle

struct Landing {
  Vec3 point = Vec3::Zero();
  AdvectStatus status = AdvectStatus::Collided;
  double travelled = 0;
};

class Walker {
 public:
  Walker(const SurfaceDistance& surface, double distance)
      : surface_(surface),
        rings_(pointRings(surface.mesh())),
        regionOf_(smoothRegions()),
        distance_(distance) {
    const double largest =
        surface.box().min().cwiseAbs().cwiseMax(surface.box().max().cwiseAbs()).maxCoeff();
    roundOff_ = kRoundOff * std::numeric_limits<double>::epsilon() * (largest + std::abs(distance));
  }

  /// One point; `direction` is its unit normal towards phi > 0. `intoCorners`: walk on at the rate
  /// of the corner instead of stopping at once.
  Landing walk(const Vec3& start, const Vec3& direction, bool intoCorners) const {
    const Vec3 along = distance_ > 0 ? direction : Vec3(-direction);
    const FootPoint home = surface_.foot(start);
    double rate = 1;
    const double bend = normalsBend(home, direction);
    if (intoCorners) rate = rateAt(start, along, home.triangle, bend);
    Landing landing{start, AdvectStatus::Collided, home.distance};
    if (rate < kLeastRate) return landing;

    const double way = std::abs(distance_) / rate;
    const double tight = std::max(roundOff_, kBisection * way) + home.distance;
    const double forgiven = tight + kTessellationLoss * way * bend;
    auto stepAt = [&](double s) {
      Step step{surface_.footFrom(start + s * along, home.triangle), tight, true};
      const double loss = rate * s - step.foot.distance;
      if (loss > tight && joinedSmoothly(home, step.foot)) step.forgiven = forgiven;
      step.arrives = loss <= step.forgiven;
      return step;
    };
    Step last = stepAt(way);
    if (last.arrives) return arrive(start, along, way, last.foot);

    double low = 0;
    double high = way;
    while (high - low >
           std::max(kBisection * std::abs(distance_), kForgivenShare * last.forgiven)) {
      const double middle = (low + high) / 2;
      if (middle <= low || middle >= high) break;
      const Step step = stepAt(middle);
      (step.arrives ? low : high) = middle;
      if (!step.arrives) last = step;
    }
    // The forgiven loss was used up behind the axis, at the rate found there: step back by it.
    const FootPoint& foot = last.foot;
    const double behind = along.dot(surface_.gradient(start + high * along, foot)) * foot.sign;
    const double overshoot = (last.forgiven - home.distance) / std::max(rate - behind, kLeastRate);
    const double stop = std::max(0.0, low - overshoot);
    landing.point = start + stop * along;
    landing.travelled = surface_.footFrom(landing.point, home.triangle).distance;
    landing.status = foot.beyondBorder ? AdvectStatus::Border : AdvectStatus::Collided;
    return landing;
  }

  /// The angle-weighted pseudonormal of a point of the mesh; zero if no triangle uses it.
  Vec3 pointNormal(Index point) const {
    const auto ring = rings_.of(point);
    if (ring.empty()) return Vec3::Zero();
    const auto& corners = surface_.mesh().triangles[static_cast<std::size_t>(ring[0])];
    FootPoint at;
    at.point = surface_.mesh().points[static_cast<std::size_t>(point)];
    at.distance = 0;
    at.triangle = ring[0];
    at.kind = FeatureKind::Vertex;
    at.corner =
        static_cast<Index>(std::find(corners.begin(), corners.end(), point) - corners.begin());
    return surface_.gradient(at.point, at);
  }

 private:
  struct Step {
    FootPoint foot;
    double forgiven = 0;   // of the loss so far
    bool arrives = false;  // the loss is no more than that
  };

  Vec3 faceNormal(Index triangle) const {
    FootPoint at;
    at.distance = 0;
    at.triangle = triangle;
    return surface_.gradient(at.point, at);
  }

  // 1 - cos of the angle between two unit normals.
  static double bendOf(const Vec3& a, const Vec3& b) { return (a - b).squaredNorm() / 2; }

  // Region of each triangle: facets that are joined over edges which turn by less than kSmoothTurn.
  std::vector<Index> smoothRegions() const {
    const TriMesh& mesh = surface_.mesh();
    DisjointSets sets(mesh.triangles.size());
    const MeshEdges edges = meshEdges(mesh);
    for (const MeshEdge& edge : edges.edges) {
      const auto sides = edges.sidesOf(edge);
      for (const Index side : sides.subspan(1)) {
        const double bend = bendOf(faceNormal(sides[0] / 3), faceNormal(side / 3));
        if (bend < kSmoothBend) sets.unite(sides[0] / 3, side / 3);
      }
    }
    std::vector<Index> region;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      region.push_back(sets.find(static_cast<Index>(t)));
    }
    return region;
  }

  // The triangles that hold a foot: several on an edge or in a point.
  std::vector<Index> trianglesAt(const FootPoint& foot) const {
    if (foot.kind == FeatureKind::Face) return {foot.triangle};
    const auto& corners = surface_.mesh().triangles[static_cast<std::size_t>(foot.triangle)];
    const auto ring = rings_.of(corners[static_cast<std::size_t>(foot.corner)]);
    std::vector<Index> found(ring.begin(), ring.end());
    if (foot.kind == FeatureKind::Vertex) return found;
    const Index end = corners[static_cast<std::size_t>((foot.corner + 1) % 3)];
    std::erase_if(found, [&](Index t) {
      const auto& other = surface_.mesh().triangles[static_cast<std::size_t>(t)];
      return std::find(other.begin(), other.end(), end) == other.end();
    });
    return found;
  }

  bool joinedSmoothly(const FootPoint& a, const FootPoint& b) const {
    const auto region = [&](Index t) { return regionOf_[static_cast<std::size_t>(t)]; };
    for (const Index t : trianglesAt(a)) {
      for (const Index u : trianglesAt(b)) {
        if (region(t) == region(u)) return true;
      }
    }
    return false;
  }

  // 1 - cos of the largest angle between `direction` and the facets around the start that continue
  // its face smoothly: what a unit of way may lose by tessellation alone.
  double normalsBend(const FootPoint& home, const Vec3& direction) const {
    const TriMesh& mesh = surface_.mesh();
    const Vec3 own = faceNormal(home.triangle);
    double most = 0;
    for (const Index point : mesh.triangles[static_cast<std::size_t>(home.triangle)]) {
      for (const Index t : rings_.of(point)) {
        const Vec3 normal = faceNormal(t);
        const bool smooth = mesh.face(t) == mesh.face(home.triangle) &&
                            bendOf(normal, own) < kSmoothBend &&
                            bendOf(normal, direction) < kSmoothBend;
        if (smooth) most = std::max(most, bendOf(normal, direction));
      }
    }
    return most;
  }

  double rateAt(const Vec3& start, const Vec3& along, Index triangle, double bend) const {
    const double probe = kProbe * std::abs(distance_);
    const double rate = surface_.footFrom(start + probe * along, triangle).distance / probe;
    const double explained = kTessellationLoss * bend + roundOff_ / probe;
    return 1 - rate <= explained ? 1 : rate;
  }

  // Newton along the path: takes out what facets and a start off the mesh leave.
  Landing arrive(const Vec3& start, const Vec3& along, double way, FootPoint foot) const {
    double s = way;
    const double target = std::abs(distance_);
    for (int i = 0; i < kNewtonSteps && std::abs(foot.distance - target) > roundOff_; ++i) {
      const Vec3 x = start + s * along;
      const double rate = along.dot(surface_.gradient(x, foot)) * foot.sign;
      if (rate < kLeastRate) break;
      const double next = s + (target - foot.distance) / rate;
      const FootPoint there = surface_.footFrom(start + next * along, foot.triangle);
      if (!(std::abs(there.distance - target) < std::abs(foot.distance - target))) break;
      s = next;
      foot = there;
    }
    return {start + s * along, AdvectStatus::Arrived, foot.distance};
  }

  const SurfaceDistance& surface_;
  PointRings rings_;
  std::vector<Index> regionOf_;  // per triangle
  double distance_;
  double roundOff_ = 0;
};

Result<void> checkOptions(const AdvectOptions& options) {
  if (!(std::abs(options.distance) < kFarthest) || options.distance == 0) {
    return fail(ErrorCode::InvalidArgument,
                fmt::format("The distance must be finite, below {:g} and not zero, not {:g}.",
                            kFarthest, options.distance),
                "distance");
  }
  if (options.threads < 0) {
    return fail(ErrorCode::InvalidArgument, "The number of threads must not be negative.",
                "threads");
  }
  return {};
}

template <class Walk>
Result<AdvectResult> walkAll(std::size_t size, int threads, const Progress& progress,
                             const Walk& walk) {
  AdvectResult result;
  result.points.resize(size);
  result.status.resize(size);
  result.travelled.resize(size);
  const auto count = static_cast<std::int64_t>(size);
  const std::int64_t chunk = std::max<std::int64_t>(4 * kGrain, count / kReports);
  for (std::int64_t from = 0; from < count; from += chunk) {
    if (!progress.report(static_cast<double>(from) / static_cast<double>(count))) {
      return fail(ErrorCode::Cancelled, "Cancelled while points were moved.");
    }
    parallelFor(std::min(chunk, count - from), threads, kGrain,
                [&](std::int64_t begin, std::int64_t end) {
                  for (std::int64_t i = from + begin; i < from + end; ++i) {
                    const auto at = static_cast<std::size_t>(i);
                    const Landing landing = walk(at);
                    result.points[at] = landing.point;
                    result.status[at] = landing.status;
                    result.travelled[at] = landing.travelled;
                  }
                });
  }
  if (!progress.report(1)) return fail(ErrorCode::Cancelled, "Cancelled.");
  return result;
}

}  // namespace

Result<AdvectResult> advectPoints(const SurfaceDistance& surface, std::span<const Vec3> start,
                                  std::span<const Vec3> normals, const AdvectOptions& options,
                                  const Progress& progress) {
  if (auto ok = checkOptions(options); !ok) return tl::unexpected(ok.error());
  if (start.size() != normals.size()) {
    return fail(
        ErrorCode::InvalidArgument,
        fmt::format("{} start points need as many normals, not {}.", start.size(), normals.size()));
  }
  for (std::size_t i = 0; i < start.size(); ++i) {
    const bool near = start[i].allFinite() && start[i].cwiseAbs().maxCoeff() < kFarthest;
    if (near && normals[i].allFinite() && normals[i].norm() > 0) continue;
    return fail(ErrorCode::InvalidArgument,
                fmt::format("Start point {} or its normal is not finite, the point is farther off "
                            "than {:g}, or the normal is zero.",
                            i, kFarthest),
                fmt::format("point {}", i));
  }
  const Walker walker(surface, options.distance);
  return walkAll(start.size(), options.threads, progress, [&](std::size_t i) {
    return walker.walk(start[i], normals[i].normalized(), false);
  });
}

Result<AdvectResult> advectMesh(const SurfaceDistance& surface, const AdvectOptions& options,
                                const Progress& progress) {
  if (auto ok = checkOptions(options); !ok) return tl::unexpected(ok.error());
  const Walker walker(surface, options.distance);
  const std::vector<Vec3>& points = surface.mesh().points;
  return walkAll(points.size(), options.threads, progress, [&](std::size_t i) {
    const Vec3 normal = walker.pointNormal(static_cast<Index>(i));
    if (normal.isZero(0)) return Landing{points[i], AdvectStatus::Collided, 0};
    return walker.walk(points[i], normal, true);
  });
}

}  // namespace phront
