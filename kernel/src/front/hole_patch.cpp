// A hole's border is not on the front's points, so the front cannot be cut along it. It is taken
// where it lies well inside the hole, and the band that is left is a polygon in space between two
// nearly parallel loops: triangles of least area (Barequet & Sharir 1995) are what one would draw.
// Weak spot: a hole narrower than two margins is such a polygon as a whole.
#include "front/hole_patch.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>

#include "phront/least_area.h"

namespace phront::facet {
namespace {

using Triangle = std::array<Index, 3>;
using Loop = std::vector<Index>;

constexpr std::size_t kMostCorners = 1200;  // of one band: the work grows with the cube
// The surface counts as being there when it faces the same way: cosine between the normals. Sheets
// back to back are told apart, the two sides of a crease are not.
constexpr double kFacing = -0.3;
constexpr double kProbe = 0.5;  // of the margin
constexpr double kSmall = 4;    // margins squared: parts of the front that are left to the band
constexpr int kRounds = 8;
// A component of the front belongs to a hole when its border runs that near to it, in margins.
constexpr double kNear = 3;

double distanceToSegment(const Vec3& x, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double t = along.squaredNorm() > 0 ? along.dot(x - a) / along.squaredNorm() : 0;
  return (x - a - std::clamp(t, 0.0, 1.0) * along).norm();
}

class PatchMaker {
 public:
  PatchMaker(const SurfaceDistance& surface, const IsoSurface& iso, const SurfaceHoles& holes)
      : surface_(surface), iso_(iso), holes_(holes) {}

  Result<CappedFront> run() {
    placeLoops();
    if (loops_.empty()) return fail(ErrorCode::InvalidArgument, "There is no hole to fill.");
    for (const Loop& loop : loops_) {
      if (loop.size() < 3)
        return fail(ErrorCode::InvalidArgument, "A loop of a hole has fewer than three corners.");
    }
    for (const Vec3& p : patch_.iso.mesh.points) {
      if (!p.allFinite())
        return fail(ErrorCode::InvalidArgument, "A corner of a hole is not a number.");
    }
    selectFront();
    cleanBorder();
    takeFront();
    for (const Border& border : borders_) {
      if (border.near.empty())
        return fail(ErrorCode::Failed, "A part of the front ends where there is no hole.");
    }
    for (const auto& group : groups()) {
      const auto corners =
          std::accumulate(group.begin(), group.end(), std::size_t{0},
                          [](std::size_t sum, const Loop& loop) { return sum + loop.size(); });
      if (corners > kMostCorners)
        return fail(ErrorCode::ResourceLimit,
                    fmt::format("A hole has {} corners, more than the {} that its least area can "
                                "be found for.",
                                corners, kMostCorners));
      const std::vector<Triangle> band = bandBetween(group);
      if (band.empty())
        return fail(ErrorCode::Failed, "The corners of a hole have no triangles over them.");
      for (const Triangle& t : band) addTriangle(t, labelAt(t));
    }
    addFans();
    return std::move(patch_);
  }

 private:
  /// Apexes and corners become the first points.
  void placeLoops() {
    std::vector<Vec3>& points = patch_.iso.mesh.points;
    std::vector<Vec3> corners;
    for (std::size_t h = 0; h < holes_.loops.size(); ++h) {
      for (const std::vector<Vec3>& loop : holes_.loops[h]) {
        points.push_back(middleOf(loop));
        loops_.emplace_back(loop.size());
        holeOf_.push_back(h);
        corners.insert(corners.end(), loop.begin(), loop.end());
      }
    }
    patch_.apexes = static_cast<Index>(points.size());
    Index next = patch_.apexes;
    for (Loop& loop : loops_)
      for (Index& corner : loop) corner = next++;
    points.insert(points.end(), corners.begin(), corners.end());
    patch_.fixedPoints = static_cast<Index>(points.size());
    patch_.iso.labels = iso_.labels;
    patch_.iso.spacing = iso_.spacing;
    patch_.iso.finestSpacing = iso_.finestSpacing;
  }

  /// Triangles of the front none of whose points has the surface within the margin.
  void selectFront() {
    std::vector<char> covered;
    for (const Vec3& x : iso_.mesh.points) covered.push_back(isCovered(x) ? 1 : 0);
    for (std::size_t t = 0; t < iso_.mesh.triangles.size(); ++t) {
      const Triangle& corners = iso_.mesh.triangles[t];
      if (std::none_of(corners.begin(), corners.end(),
                       [&](Index p) { return covered[static_cast<std::size_t>(p)] != 0; }))
        chosen_.push_back(static_cast<Index>(t));
    }
  }
  /// Asked from a little before and behind, too: next to a thin gap or wall the other side of it
  /// may be nearer.
  [[nodiscard]] bool isCovered(const Vec3& x) const {
    if (holes_.around.foot(x, holes_.margin).triangle == kNone) return false;
    const Vec3 normal = surface_.gradient(x, surface_.foot(x));
    for (const double step : {0.0, kProbe, -kProbe}) {
      const FootPoint near =
          holes_.around.foot(x + step * holes_.margin * normal, (1 + kProbe) * holes_.margin);
      if (near.triangle != kNone && (near.point - x).norm() <= holes_.margin &&
          normalOf(near.triangle).dot(normal) > kFacing)
        return true;
    }
    return false;
  }
  [[nodiscard]] Vec3 normalOf(Index triangle) const {
    const TriMesh& mesh = holes_.around.mesh();
    const auto at = [&](std::size_t k) -> const Vec3& {
      return mesh
          .points[static_cast<std::size_t>(mesh.triangles[static_cast<std::size_t>(triangle)][k])];
    };
    return (at(1) - at(0)).cross(at(2) - at(0)).normalized();
  }

  /// Takes away triangles with two free sides and those around points where the border meets
  /// itself, until there are none.
  void cleanBorder() {
    for (;;) {
      std::map<std::pair<Index, Index>, int> uses;
      for (const Index t : chosen_)
        for (std::size_t k = 0; k < 3; ++k) ++uses[side(t, k)];
      std::map<Index, int> borders;  // sides of the border that begin at a point
      for (const auto& [s, count] : uses)
        if (!uses.contains({s.second, s.first})) ++borders[s.first];
      const auto end = std::remove_if(chosen_.begin(), chosen_.end(), [&](Index t) {
        int free = 0;
        bool pinched = false;
        for (std::size_t k = 0; k < 3; ++k) {
          const auto [a, b] = side(t, k);
          if (!uses.contains({b, a})) ++free;
          const auto at = borders.find(a);
          pinched = pinched || (at != borders.end() && at->second > 1);
        }
        return free > 1 || pinched;
      });
      if (end == chosen_.end()) return;
      chosen_.erase(end, chosen_.end());
    }
  }
  [[nodiscard]] std::pair<Index, Index> side(Index t, std::size_t k) const {
    const Triangle& corners = iso_.mesh.triangles[static_cast<std::size_t>(t)];
    return {corners[k], corners[(k + 1) % 3]};
  }

  /// Connected parts of the chosen triangles that are closed or reach a hole; their borders.
  void takeFront() {
    std::map<std::pair<Index, Index>, std::size_t> owner;
    for (std::size_t i = 0; i < chosen_.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) owner[side(chosen_[i], k)] = i;
    std::vector<char> seen(chosen_.size(), 0);
    std::map<Index, Index> renumbered;
    for (std::size_t seed = 0; seed < chosen_.size(); ++seed) {
      if (seen[seed]) continue;
      seen[seed] = 1;
      std::vector<std::size_t> part{seed};
      std::map<Index, Index> next;  // along the border
      for (std::size_t i = 0; i < part.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
          const auto [a, b] = side(chosen_[part[i]], k);
          const auto beyond = owner.find({b, a});
          if (beyond == owner.end()) {
            next[a] = b;
          } else if (!seen[beyond->second]) {
            seen[beyond->second] = 1;
            part.push_back(beyond->second);
          }
        }
      }
      const bool reachesHole = std::any_of(next.begin(), next.end(), [&](const auto& entry) {
        return !loopsNear({entry.first}).empty();
      });
      if (!next.empty() && (!reachesHole || isSmall(part))) continue;
      const auto number = [&](Index p) {
        const auto [at, isNew] =
            renumbered.try_emplace(p, static_cast<Index>(patch_.iso.mesh.points.size()));
        if (isNew) patch_.iso.mesh.points.push_back(iso_.mesh.points[static_cast<std::size_t>(p)]);
        return at->second;
      };
      for (const std::size_t i : part) {
        const auto t = static_cast<std::size_t>(chosen_[i]);
        const Triangle& c = iso_.mesh.triangles[t];
        addTriangle({number(c[0]), number(c[1]), number(c[2])},
                    iso_.mesh.faceOf.empty() ? 0 : iso_.mesh.faceOf[t]);
      }
      while (!next.empty()) {
        Loop onFront;
        for (Index p = next.begin()->first; next.contains(p);) {
          onFront.push_back(p);
          const Index to = next.at(p);
          next.erase(p);
          p = to;
        }
        Border border{{}, loopsNear(onFront)};
        for (const Index p : onFront) border.loop.push_back(number(p));
        std::reverse(border.loop.begin(), border.loop.end());  // what it lacks on its left
        borders_.push_back(std::move(border));
      }
    }
  }
  [[nodiscard]] bool isSmall(const std::vector<std::size_t>& part) const {
    double area = 0;
    for (const std::size_t i : part) {
      const Triangle& c = iso_.mesh.triangles[static_cast<std::size_t>(chosen_[i])];
      const auto at = [&](std::size_t k) -> const Vec3& {
        return iso_.mesh.points[static_cast<std::size_t>(c[k])];
      };
      area += (at(1) - at(0)).cross(at(2) - at(0)).norm() / 2;
    }
    return area < kSmall * holes_.margin * holes_.margin;
  }
  /// Loops of holes that points of the front are near to.
  [[nodiscard]] std::vector<std::size_t> loopsNear(const std::vector<Index>& points) const {
    std::vector<std::size_t> near;
    for (std::size_t l = 0; l < loops_.size(); ++l) {
      if (std::any_of(points.begin(), points.end(), [&](Index p) {
            return isNear(iso_.mesh.points[static_cast<std::size_t>(p)], loops_[l]);
          }))
        near.push_back(l);
    }
    return near;
  }
  [[nodiscard]] bool isNear(const Vec3& x, const Loop& loop) const {
    const std::vector<Vec3>& points = patch_.iso.mesh.points;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      if (distanceToSegment(x, points[static_cast<std::size_t>(loop[k])],
                            points[static_cast<std::size_t>(loop[(k + 1) % loop.size()])]) <=
          kNear * holes_.margin)
        return true;
    }
    return false;
  }

  /// Loops that bound one band: of a part of the front and the holes' loops near to it, and those
  /// of one hole that no part of the front is near to.
  [[nodiscard]] std::vector<std::vector<Loop>> groups() const {
    std::vector<std::size_t> parent(loops_.size());
    std::iota(parent.begin(), parent.end(), std::size_t{0});
    const auto root = [&](std::size_t l) {
      while (parent[l] != l) l = parent[l];
      return l;
    };
    std::vector<char> alone(loops_.size(), 1);
    for (const Border& border : borders_) {
      for (const std::size_t l : border.near) {
        parent[root(l)] = root(border.near.front());
        alone[l] = 0;
      }
    }
    for (std::size_t l = 0; l < loops_.size(); ++l)
      for (std::size_t other = 0; alone[l] && other < l; ++other)
        if (holeOf_[other] == holeOf_[l]) parent[root(l)] = root(other);
    std::map<std::size_t, std::vector<Loop>> grouped;
    for (std::size_t l = 0; l < loops_.size(); ++l) grouped[root(l)].push_back(loops_[l]);
    for (const Border& border : borders_) grouped[root(border.near.front())].push_back(border.loop);
    std::vector<std::vector<Loop>> result;
    for (auto& [number, group] : grouped) result.push_back(std::move(group));
    return result;
  }

  /// Empty where no triangles fill what is between the loops.
  [[nodiscard]] std::vector<Triangle> bandBetween(const std::vector<Loop>& loops) const {
    const Loop polygon = joinLoops(loops, patch_.iso.mesh.points);
    TakenSides taken = takenSides(polygon);
    for (int round = 0; round < kRounds; ++round) {
      const std::vector<Triangle> band =
          leastAreaTriangles(polygon, patch_.iso.mesh.points, Flat::Avoided, taken);
      // Where corners come twice, so may a side.
      std::map<std::pair<Index, Index>, int> uses;
      for (const Triangle& t : band)
        for (std::size_t k = 0; k < 3; ++k) ++uses[{t[k], t[(k + 1) % 3]}];
      const std::size_t before = taken.size();
      for (const auto& [side, count] : uses)
        if (count > 1) taken.insert(std::minmax(side.first, side.second));
      if (taken.size() == before) return band;
    }
    return {};
  }

  /// Sides between the corners of a polygon that no band may have: its own, those of the front, and
  /// those without length, where loops touch.
  [[nodiscard]] TakenSides takenSides(const Loop& polygon) const {
    const std::set<Index> corners(polygon.begin(), polygon.end());
    TakenSides taken;
    for (std::size_t k = 0; k < polygon.size(); ++k)
      taken.insert(std::minmax(polygon[k], polygon[(k + 1) % polygon.size()]));
    for (const Triangle& t : patch_.iso.mesh.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto ends = std::minmax(t[k], t[(k + 1) % 3]);
        if (corners.contains(ends.first) && corners.contains(ends.second)) taken.insert(ends);
      }
    }
    const auto less = [&](Index a, Index b) {
      const Vec3& p = patch_.iso.mesh.points[static_cast<std::size_t>(a)];
      const Vec3& q = patch_.iso.mesh.points[static_cast<std::size_t>(b)];
      return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
    };
    std::vector<Index> sorted(corners.begin(), corners.end());
    std::stable_sort(sorted.begin(), sorted.end(), less);
    for (std::size_t i = 0; i < sorted.size(); ++i)
      for (std::size_t j = i + 1; j < sorted.size() && !less(sorted[i], sorted[j]); ++j)
        taken.insert(std::minmax(sorted[i], sorted[j]));
    return taken;
  }

  [[nodiscard]] Index labelAt(const Triangle& t) {
    Vec3 middle = Vec3::Zero();
    for (const Index p : t) middle += patch_.iso.mesh.points[static_cast<std::size_t>(p)] / 3;
    const Feature feature = surface_.featureOf(surface_.foot(middle));
    std::vector<Feature>& labels = patch_.iso.labels;
    const auto at = std::find(labels.begin(), labels.end(), feature);
    if (at == labels.end()) {
      labels.push_back(feature);
      return static_cast<Index>(labels.size() - 1);
    }
    return static_cast<Index>(at - labels.begin());
  }
  void addTriangle(const Triangle& corners, Index label) {
    patch_.iso.mesh.triangles.push_back(corners);
    patch_.iso.mesh.faceOf.push_back(label);
  }

  void addFans() {
    if (patch_.iso.labels.empty()) patch_.iso.labels.push_back({});
    for (std::size_t l = 0; l < loops_.size(); ++l)
      addFan(patch_.iso.mesh, loops_[l], static_cast<Index>(l));
  }

  /// Of a part of the front.
  struct Border {
    Loop loop;
    std::vector<std::size_t> near;  ///< loops of holes
  };

  const SurfaceDistance& surface_;
  const IsoSurface& iso_;
  const SurfaceHoles& holes_;
  CappedFront patch_;
  std::vector<Loop> loops_;
  std::vector<std::size_t> holeOf_;  ///< per loop
  std::vector<Index> chosen_;        ///< triangles of the front
  std::vector<Border> borders_;
};

}  // namespace

Result<CappedFront> makeHolePatch(const SurfaceDistance& surface, const IsoSurface& iso,
                                  const SurfaceHoles& holes) {
  return PatchMaker(surface, iso, holes).run();
}

}  // namespace phront::facet
