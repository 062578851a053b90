// The pipe round an edge folds where its sections meet their neighbours: where 1 = |d| k.n for the
// curvature k of the edge and a direction n of the section. The ridge at which the two halves of a
// rim's pipe are cut off ends where the fold comes nearest to the side that stays: at the ends of
// the long axis of an ellipse.
// Weak spot: rims with more than two such places, from which a ridge with branches grows, are taken
// for rims with two; following the ridge then fails.
#include "patches/rims.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepTools_ReShape.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Eigen/Dense>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "patches/bends.h"
#include "patches/patch_tools.h"

namespace phront::cad {
namespace {

constexpr std::size_t kMostEdges = 8;  // of a rim
constexpr int kPlaces = 48;            // along an edge, to find where it folds first
constexpr double kNearVertex = 0.007;  // of the rim: a tip so near a vertex is there
constexpr double kApart = 0.2;         // of the rim: the two tips at least
constexpr double kWindow = 0.1;        // of the rim, to either side, that tells where a tip is
constexpr int kRefinements = 3;

/// Angle from `kept` towards `cut` at which the section folds; nullopt when it does not.
std::optional<double> foldAngle(const gp_Vec& curvature, double radius, const gp_Vec& kept,
                                const gp_Vec& cut) {
  gp_Vec across = cut - kept * cut.Dot(kept);
  if (across.Magnitude() < kAngularTolerance) return std::nullopt;
  across.Normalize();
  // radius * (cos(a) k.kept + sin(a) k.across) = 1, first root.
  const double c = radius * curvature.Dot(kept);
  const double s = radius * curvature.Dot(across);
  const double size = std::hypot(c, s);
  if (c >= 1 || size <= 1) return std::nullopt;
  const double angle = std::atan2(s, c) - std::acos(1 / size);
  if (angle <= 0 || angle >= kept.Angle(cut)) return std::nullopt;
  return angle;
}

/// Where along an edge, and how far from the side that stays, its pipe folds.
struct Fold {
  double share = 0;
  double angle = 0;
};

/// At kPlaces + 1 places; empty unless it folds at each of them.
std::vector<Fold> foldsOf(const EdgeInfo& info, double radius) {
  if (info.samples.size() < 2 || !info.pipe) return {};
  const BRepAdaptor_Curve curve(info.edge);
  std::vector<Fold> folds;
  for (int i = 0; i <= kPlaces; ++i) {
    const double share = static_cast<double>(i) / kPlaces;
    const double t = std::lerp(curve.FirstParameter(), curve.LastParameter(), share);
    const std::optional<Bend> bend = bendAt(info, curve, t);
    if (!bend) return {};
    const auto& [n1, n2, curvature] = *bend;
    const bool keeps2 = curvature.Dot(n2) < curvature.Dot(n1);
    const std::optional<double> angle =
        keeps2 ? foldAngle(curvature, radius, n2, n1) : foldAngle(curvature, radius, n1, n2);
    if (!angle) return {};
    folds.push_back({share, *angle});
  }
  return folds;
}

TopoDS_Vertex endOf(const RimEdge& use, const EdgeTable& table) {
  const TopoDS_Edge& edge = table.edges[static_cast<std::size_t>(use.edge)].edge;
  return use.forward ? TopExp::LastVertex(edge) : TopExp::FirstVertex(edge);
}

/// From the far end of `from` over the edges `isPart` to `end`; empty when the way forks or stops.
template <class IsPart>
RimHalf follow(const EdgeTable& table, RimEdge from, const TopoDS_Vertex& end, IsPart&& isPart) {
  RimHalf way{from};
  while (!endOf(way.back(), table).IsSame(end)) {
    if (way.size() == kMostEdges) return {};
    const TopoDS_Vertex at = endOf(way.back(), table);
    std::vector<int> next;
    for (const int e : table.edgesAt[static_cast<std::size_t>(table.vertexIndex.FindIndex(at) - 1)])
      if (e != way.back().edge && isPart(e)) next.push_back(e);
    if (next.size() != 1) return {};
    const TopoDS_Edge& edge = table.edges[static_cast<std::size_t>(next[0])].edge;
    way.push_back({next[0], TopExp::FirstVertex(edge).IsSame(at)});
  }
  return way;
}

/// A place on a rim and how far from the side that stays the pipe folds there.
struct RimPlace {
  std::size_t edge = 0;  ///< of the rim
  double share = 0;      ///< of that edge's parameters
  double along = 0;      ///< length from the rim's start
  double angle = 0;
};

struct RimPlaces {
  std::vector<RimPlace> places;
  double length = 0;

  /// From `from` to `to` along the rim, the shorter way.
  [[nodiscard]] double way(double from, double to) const {
    return std::remainder(to - from, length);
  }

  /// The place of least angle among those at least kApart from `other`.
  [[nodiscard]] double least(std::optional<double> other) const {
    const RimPlace* best = nullptr;
    for (const RimPlace& place : places) {
      if (other && std::abs(way(*other, place.along)) < kApart * length) continue;
      if (best == nullptr || place.angle < best->angle) best = &place;
    }
    double at = best->along;
    for (int i = 0; i < kRefinements; ++i) at = settled(at);
    return at < 0 ? at + length : at >= length ? at - length : at;
  }

 private:
  /// The vertex of the parabola that fits the angles about `at`: the curvature of an edge that was
  /// approximated is uneven.
  [[nodiscard]] double settled(double at) const {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const RimPlace& place : places) {
      const double x = way(at, place.along) / (kWindow * length);
      if (std::abs(x) > 1) continue;
      const Eigen::Vector3d row(1, x, x * x);
      normal += row * row.transpose();
      right += row * place.angle;
    }
    const Eigen::Vector3d c = normal.fullPivLu().solve(right);
    if (!c.allFinite() || c[2] <= 0) return at;
    return at + std::clamp(-c[1] / (2 * c[2]), -1.0, 1.0) * kWindow * length;
  }
};

class RimDivider {
 public:
  RimDivider(const TopoDS_Shape& shape, double distance, double smoothAngle)
      : shape_(shape),
        radius_(std::abs(distance)),
        table_(makeEdgeTable(shape, distance > 0 ? 1 : -1, smoothAngle)) {
    for (const EdgeInfo& info : table_.edges) folds_.push_back(foldsOf(info, radius_));
  }

  DividedRims run(const std::set<std::size_t>& leaveOut) {
    DividedRims result{shape_, {}};
    const std::vector<RimHalf> all = rims();
    for (std::size_t r = 0; r < all.size(); ++r) {
      if (leaveOut.count(r) > 0) continue;
      const RimPlaces places = placesOf(all[r]);
      const double one = places.least({});
      const double other = places.least(one);
      result.tips.push_back({vertexAt(all[r], places, one), vertexAt(all[r], places, other), r});
    }
    result.shape = divided();
    return result;
  }

  /// A pipe that folds passes through itself, which General Fuse does not see; its halves on either
  /// side of where it bends most cross one another.
  TopoDS_Shape runAtBends() {
    std::set<int> onRims;
    for (const RimHalf& rim : rims())
      for (const RimEdge& use : rim) onRims.insert(use.edge);
    for (int e = 0; e < static_cast<int>(table_.edges.size()); ++e) {
      if (onRims.count(e) > 0) continue;
      const EdgeInfo& info = table_.edges[static_cast<std::size_t>(e)];
      for (const double share : tightBends(info, radius_)) {
        const BRepAdaptor_Curve curve(info.edge);
        const double t = std::lerp(curve.FirstParameter(), curve.LastParameter(), share);
        cuts_[e].emplace(share, makeVertex(curve.Value(t), BRep_Tool::Tolerance(info.edge)));
      }
    }
    return divided();
  }

 private:
  using Cuts = std::map<double, TopoDS_Vertex>;  ///< by share

  [[nodiscard]] bool folds(int e) const { return !folds_[static_cast<std::size_t>(e)].empty(); }

  [[nodiscard]] std::vector<RimHalf> rims() const {
    std::vector<RimHalf> found;
    std::set<int> used;
    for (int e = 0; e < static_cast<int>(table_.edges.size()); ++e) {
      if (!folds(e) || used.count(e) > 0) continue;
      const TopoDS_Vertex start =
          TopExp::FirstVertex(table_.edges[static_cast<std::size_t>(e)].edge);
      const RimHalf rim = follow(table_, {e, true}, start, [&](int next) { return folds(next); });
      bool circles = true;
      for (const RimEdge& use : rim) {
        used.insert(use.edge);
        const BRepAdaptor_Curve curve(table_.edges[static_cast<std::size_t>(use.edge)].edge);
        circles = circles && curve.GetType() == GeomAbs_Circle;
      }
      if (rim.size() > 1 && !circles) found.push_back(rim);
    }
    return found;
  }

  [[nodiscard]] TopoDS_Shape divided() const {
    if (cuts_.empty()) return shape_;
    BRepTools_ReShape reshape;
    for (const auto& [edge, cuts] : cuts_) divide(edge, cuts, reshape);
    return reshape.Apply(shape_);
  }

  /// The rim in kPlaces steps an edge; consecutive edges share the place between them.
  [[nodiscard]] RimPlaces placesOf(const RimHalf& rim) const {
    RimPlaces result;
    for (std::size_t k = 0; k < rim.size(); ++k) {
      const auto e = static_cast<std::size_t>(rim[k].edge);
      const BRepAdaptor_Curve curve(table_.edges[e].edge);
      std::vector<Fold> folds = folds_[e];
      if (!rim[k].forward) std::reverse(folds.begin(), folds.end());
      gp_Pnt before;
      for (std::size_t i = 0; i < folds.size(); ++i) {
        const gp_Pnt p =
            curve.Value(std::lerp(curve.FirstParameter(), curve.LastParameter(), folds[i].share));
        if (i > 0) result.length += p.Distance(before);
        before = p;
        result.places.push_back({k, folds[i].share, result.length, folds[i].angle});
      }
    }
    return result;
  }

  /// A new vertex, or that of the edge's end nearby.
  TopoDS_Vertex vertexAt(const RimHalf& rim, const RimPlaces& rimPlaces, double along) {
    const std::vector<RimPlace>& places = rimPlaces.places;
    std::size_t i = 1;
    while (i + 1 < places.size() &&
           (places[i].along < along || places[i].edge != places[i - 1].edge))
      ++i;
    const RimPlace& a = places[i - 1];
    const RimPlace& b = places[i];
    const double share = std::lerp(a.share, b.share, (along - a.along) / (b.along - a.along));
    const RimEdge& use = rim[a.edge];
    const TopoDS_Edge& edge = table_.edges[static_cast<std::size_t>(use.edge)].edge;
    const double near = kNearVertex * rimPlaces.length;
    const auto ofEdge = [&](const RimPlace& place) { return place.edge == a.edge; };
    const RimPlace& start = *std::find_if(places.begin(), places.end(), ofEdge);
    const RimPlace& end = *std::find_if(places.rbegin(), places.rend(), ofEdge);
    if (along - start.along < near)
      return use.forward ? TopExp::FirstVertex(edge) : TopExp::LastVertex(edge);
    if (end.along - along < near)
      return use.forward ? TopExp::LastVertex(edge) : TopExp::FirstVertex(edge);
    const BRepAdaptor_Curve curve(edge);
    const TopoDS_Vertex vertex =
        makeVertex(curve.Value(std::lerp(curve.FirstParameter(), curve.LastParameter(), share)),
                   BRep_Tool::Tolerance(edge));
    cuts_[use.edge].emplace(share, vertex);
    return vertex;
  }

  void divide(int e, const Cuts& cuts, BRepTools_ReShape& reshape) const {
    const TopoDS_Edge& edge = table_.edges[static_cast<std::size_t>(e)].edge;
    double first = 0;
    double last = 0;
    BRep_Tool::Range(edge, first, last);
    const BRep_Builder builder;
    TopoDS_Wire wire;
    builder.MakeWire(wire);
    TopoDS_Vertex from = TopExp::FirstVertex(edge);
    double t0 = first;
    const auto add = [&](const TopoDS_Vertex& to, double t1) {
      TopoDS_Edge part = TopoDS::Edge(edge.EmptyCopied());
      builder.Add(part, from.Oriented(TopAbs_FORWARD));
      builder.Add(part, to.Oriented(TopAbs_REVERSED));
      builder.Range(part, t0, t1);
      builder.Add(wire, part);
      from = to;
      t0 = t1;
    };
    for (const auto& [share, vertex] : cuts) add(vertex, std::lerp(first, last, share));
    add(TopExp::LastVertex(edge), last);
    reshape.Replace(edge, wire);
  }

  TopoDS_Shape shape_;
  double radius_;
  EdgeTable table_;
  std::vector<std::vector<Fold>> folds_;  ///< by edge
  std::map<int, Cuts> cuts_;
};

}  // namespace

DividedRims divideRims(const TopoDS_Shape& shape, double distance, double smoothAngle,
                       const std::set<std::size_t>& leaveOut) {
  return RimDivider(shape, distance, smoothAngle).run(leaveOut);
}

TopoDS_Shape divideBends(const TopoDS_Shape& shape, double distance, double smoothAngle) {
  return RimDivider(shape, distance, smoothAngle).runAtBends();
}

std::optional<std::pair<RimHalf, RimHalf>> rimHalves(const EdgeTable& table, const RimTips& tips) {
  const int at = table.vertexIndex.FindIndex(tips.one);
  if (at == 0) return std::nullopt;
  const auto isPipe = [&](int e) { return table.edges[static_cast<std::size_t>(e)].pipe; };
  std::vector<RimHalf> halves;
  for (const int e : table.edgesAt[static_cast<std::size_t>(at - 1)]) {
    if (!isPipe(e)) continue;
    const TopoDS_Edge& edge = table.edges[static_cast<std::size_t>(e)].edge;
    const RimEdge start{e, TopExp::FirstVertex(edge).IsSame(tips.one)};
    halves.push_back(follow(table, start, tips.other, isPipe));
  }
  if (halves.size() != 2 || halves[0].empty() || halves[1].empty()) return std::nullopt;
  return std::pair(halves[0], halves[1]);
}

}  // namespace phront::cad
