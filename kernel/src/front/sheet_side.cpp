// The front around a sheet is closed: pipes along the free edges join its two sides. It is cut
// where feet leave the side wanted, on the sides of triangles between a point whose foot is there
// and one whose foot is not. Where the border bends between two cuts, points are put in.
// Weak spot: where feet change twice along one side of a triangle, nothing is cut.
#include "front/sheet_side.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace phront::facet {
namespace {

constexpr int kHalvings = 40;
// Cuts keep off the ends of a side by this share of it: no triangle is flatter.
constexpr double kOffEnds = 0.02;
// Where the winding number is asked for, in distances before and behind the sheet, and how much it
// must differ.
constexpr std::array kProbes{0.25, 0.05, 0.01};
constexpr double kLeastFall = 0.25;
constexpr int kMostBends = 6;  // halvings of the border between two cuts

using Triangle = std::array<Index, 3>;
using Side = std::pair<Index, Index>;

/// Points of the front keep their numbers until the end; those of the cuts follow them.
class SideCutter {
 public:
  SideCutter(const SurfaceDistance& sheet, const IsoSurface& wrap, double distance,
             double tolerance)
      : sheet_(sheet),
        wrap_(wrap),
        distance_(distance),
        tolerance_(tolerance),
        points_(wrap.mesh.points) {}

  CappedFront run() {
    placePoints();
    for (std::size_t t = 0; t < wrap_.mesh.triangles.size(); ++t) cutTriangle(t);
    bendBorders();
    return capped(borders());
  }

 private:
  /// Unsure: the foot is within the sheet, its side is not known.
  enum class Place : std::uint8_t { Beside, Unsure, Elsewhere };

  [[nodiscard]] Place placeOf(const Vec3& x) const {
    const FootPoint foot = sheet_.foot(x);
    if (foot.beyondBorder) return Place::Elsewhere;
    const double side = sideOf(x, foot);
    if (side == 0) return Place::Unsure;
    return (side > 0) == (distance_ > 0) ? Place::Beside : Place::Elsewhere;
  }
  /// Between a point that stays and one that goes: unsure ones stay.
  [[nodiscard]] bool isBeside(const Vec3& x) const { return placeOf(x) != Place::Elsewhere; }
  /// +1, -1, or 0 where it cannot be told. At edges and corners normals may disagree, above all
  /// where faces fold back or the part is untidy: there the winding number tells, which falls by
  /// one from the inner to the outer side, by a half around a free edge; not behind a thin wall.
  [[nodiscard]] double sideOf(const Vec3& x, const FootPoint& foot) const {
    if (foot.kind == FeatureKind::Face) return foot.sign;
    for (const double share : kProbes) {
      const Vec3 step = share * (x - foot.point);
      const double fall =
          sheet_.windingNumber(foot.point - step) - sheet_.windingNumber(foot.point + step);
      if (std::abs(fall) > kLeastFall) return fall > 0 ? 1 : -1;
    }
    return 0;
  }

  /// Where a point cannot tell, its neighbours do, from the sure ones on.
  void placePoints() {
    for (const Vec3& x : points_) places_.push_back(placeOf(x));
    for (bool again = true; again;) {
      again = false;
      std::map<Index, int> votes;  // of the neighbours of unsure points
      for (const Triangle& t : wrap_.mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
          if (place(t[k]) != Place::Unsure) continue;
          for (const Index other : {t[(k + 1) % 3], t[(k + 2) % 3]}) {
            if (place(other) != Place::Unsure)
              votes[t[k]] += place(other) == Place::Beside ? 1 : -1;
          }
        }
      }
      for (const auto& [p, sum] : votes) {
        place(p) = sum >= 0 ? Place::Beside : Place::Elsewhere;
        again = true;
      }
    }
  }
  [[nodiscard]] Place& place(Index p) { return places_[static_cast<std::size_t>(p)]; }
  [[nodiscard]] bool stays(Index p) const {
    return places_[static_cast<std::size_t>(p)] != Place::Elsewhere;
  }
  [[nodiscard]] const Vec3& at(Index p) const { return points_[static_cast<std::size_t>(p)]; }

  void cutTriangle(std::size_t t) {
    const Triangle& corners = wrap_.mesh.triangles[t];
    std::vector<Index> left;
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = corners[k];
      const Index b = corners[(k + 1) % 3];
      if (stays(a)) left.push_back(a);
      if (stays(a) != stays(b)) left.push_back(cutBetween(a, b));
    }
    const Index label = wrap_.mesh.faceOf.empty() ? 0 : wrap_.mesh.faceOf[t];
    if (left.size() == 3) add({left[0], left[1], left[2]}, label);
    if (left.size() != 4) return;
    const bool odd = (at(left[1]) - at(left[3])).norm() < (at(left[0]) - at(left[2])).norm();
    if (odd) std::rotate(left.begin(), left.begin() + 1, left.end());
    add({left[0], left[1], left[2]}, label);
    add({left[0], left[2], left[3]}, label);
  }
  void add(const Triangle& corners, Index label) {
    triangles_.push_back(corners);
    labels_.push_back(label);
  }

  /// The number of the point where feet leave the side, on the front.
  Index cutBetween(Index a, Index b) {
    const auto [cut, isNew] = cuts_.try_emplace(std::minmax(a, b), kNone);
    if (!isNew) return cut->second;
    const Vec3& from = stays(a) ? at(a) : at(b);
    const Vec3 along = (stays(a) ? at(b) : at(a)) - from;
    const double share = std::clamp(lastBeside(from, along), kOffEnds, 1 - kOffEnds);
    cut->second = addPoint(onFront(from + share * along));
    return cut->second;
  }
  /// In steps: how far feet stay on the side.
  [[nodiscard]] double lastBeside(const Vec3& from, const Vec3& step) const {
    double inside = 0;
    double outside = 1;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = (inside + outside) / 2;
      (isBeside(from + middle * step) ? inside : outside) = middle;
    }
    return inside;
  }
  [[nodiscard]] Vec3 onFront(const Vec3& x) const {
    const Vec3 foot = sheet_.foot(x).point;
    return foot + std::abs(distance_) * (x - foot).normalized();
  }
  Index addPoint(const Vec3& x) {
    points_.push_back(x);
    return static_cast<Index>(points_.size() - 1);
  }

  /// Triangles with a side on the border get more corners there.
  void bendBorders() {
    const std::set<Side> sides = allSides();
    const std::size_t count = triangles_.size();
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Triangle t = triangles_[i];
        const Index a = t[k];
        const Index b = t[(k + 1) % 3];
        if (sides.contains({b, a})) continue;
        std::vector<Index> chain{a};
        bend(a, b, kMostBends, chain);
        chain.push_back(b);
        triangles_[i] = {chain[0], chain[1], t[(k + 2) % 3]};
        for (std::size_t c = 1; c + 1 < chain.size(); ++c)
          add({chain[c], chain[c + 1], t[(k + 2) % 3]}, labels_[i]);
        break;  // no triangle has two
      }
    }
  }
  /// Adds points of the border between two of them, if it leaves the line.
  void bend(Index a, Index b, int most, std::vector<Index>& chain) {
    const Vec3 along = at(b) - at(a);
    if (most == 0 || along.norm() <= tolerance_) return;
    const Vec3 middle = (at(a) + at(b)) / 2;
    const Vec3 away = (middle - sheet_.foot(middle).point).normalized();
    const bool beside = isBeside(middle);
    const Vec3 step = (beside ? 1 : -1) * along.cross(away);  // to the right lies what went
    if (isBeside(middle + step) == beside) return;
    const double share = beside ? lastBeside(middle, step) : 1 - lastBeside(middle + step, -step);
    if (share * step.norm() <= tolerance_) return;
    const Index between = addPoint(onFront(middle + share * step));
    bend(a, between, most - 1, chain);
    chain.push_back(between);
    bend(between, b, most - 1, chain);
  }

  [[nodiscard]] std::set<Side> allSides() const {
    std::set<Side> sides;
    for (const Triangle& t : triangles_)
      for (std::size_t k = 0; k < 3; ++k) sides.insert({t[k], t[(k + 1) % 3]});
    return sides;
  }

  /// Loops of sides without a neighbour, the front on their left.
  [[nodiscard]] std::vector<std::vector<Index>> borders() const {
    const std::set<Side> sides = allSides();
    std::map<Index, Index> next;
    for (const auto& [a, b] : sides)
      if (!sides.contains({b, a})) next[a] = b;
    std::vector<std::vector<Index>> loops;
    while (!next.empty()) {
      loops.emplace_back();
      for (Index p = next.begin()->first; next.contains(p);) {
        loops.back().push_back(p);
        const Index to = next.at(p);
        next.erase(p);
        p = to;
      }
    }
    return loops;
  }

  [[nodiscard]] CappedFront capped(const std::vector<std::vector<Index>>& loops) const {
    CappedFront made;
    made.iso.labels = wrap_.labels;
    made.iso.spacing = wrap_.spacing;
    made.iso.finestSpacing = wrap_.finestSpacing;
    TriMesh& mesh = made.iso.mesh;
    for (const std::vector<Index>& loop : loops) {
      std::vector<Vec3> corners;
      for (const Index p : loop) corners.push_back(at(p));
      mesh.points.push_back(middleOf(corners));
    }
    made.apexes = static_cast<Index>(mesh.points.size());
    std::vector<Index> number(points_.size(), kNone);
    const auto numbered = [&](Index p) {
      Index& n = number[static_cast<std::size_t>(p)];
      if (n == kNone) {
        n = static_cast<Index>(mesh.points.size());
        mesh.points.push_back(at(p));
      }
      return n;
    };
    std::vector<std::vector<Index>> borders = loops;
    for (std::vector<Index>& loop : borders)
      for (Index& p : loop) p = numbered(p);
    made.fixedPoints = static_cast<Index>(mesh.points.size());
    for (const Triangle& t : triangles_)
      mesh.triangles.push_back({numbered(t[0]), numbered(t[1]), numbered(t[2])});
    mesh.faceOf = labels_;
    for (std::size_t l = 0; l < borders.size(); ++l)
      addFan(mesh, borders[l], static_cast<Index>(l));
    return made;
  }

  const SurfaceDistance& sheet_;
  const IsoSurface& wrap_;
  const double distance_;
  const double tolerance_;
  std::vector<Vec3> points_;
  std::vector<Place> places_;  ///< per point of the front
  std::map<Side, Index> cuts_;
  std::vector<Triangle> triangles_;
  std::vector<Index> labels_;
};

}  // namespace

CappedFront frontBesideSheet(const SurfaceDistance& sheet, const IsoSurface& wrap, double distance,
                             double tolerance) {
  return SideCutter(sheet, wrap, distance, tolerance).run();
}

}  // namespace phront::facet
