// OpenCASCADE's deflection is a target that it misses by a factor of up to ten on small curved
// faces. Sides that deviate too much are halved, triangles cut in two, three or four accordingly
// ("red-green" without the removal of green; Bank, Sherman & Weiser 1983), a few rounds long. What
// the corners of a side miss by stays: it is the B-Rep's own gap between edge and surface.
#include "tessellate/refine.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRep_Tool.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <map>
#include <optional>

namespace phront::cad {
namespace {

constexpr int kRounds = 4;           // errors fall by four in each
constexpr double kAllowed = 1.5;     // of the deflection
constexpr double kTangentRatio = 4;  // parameters off by more heights than this are not trusted
constexpr std::size_t kMaxTriangles = 1'500'000;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

using Side = std::pair<Index, Index>;

class Refiner {
 public:
  Refiner(Soup& soup, const ShapeIndex& index, double deflection)
      : soup_(soup), index_(index), deflection_(deflection) {
    curves_.resize(index.uses.size());
  }

  bool round() {
    splits_.clear();
    for (const SoupTriangle& t : soup_.triangles) {
      if (t.patch != kNone) continue;
      for (std::size_t k = 0; k < 3; ++k) markSide(t, k);
    }
    // A patch keeps its shape, so the sides it shares stay whole.
    for (const SoupTriangle& t : soup_.triangles) {
      for (std::size_t k = 0; k < 3 && t.patch != kNone; ++k) splits_.erase(sideOf(t, k));
    }
    if (splits_.empty()) return false;
    for (auto& [side, split] : splits_) {
      split.point = static_cast<Index>(soup_.points.size());
      soup_.points.push_back(split.position);
      soup_.vertexOf.push_back(kNone);
    }
    std::vector<SoupTriangle> old;
    old.swap(soup_.triangles);
    for (const SoupTriangle& t : old) cut(t);
    return true;
  }

 private:
  struct Split {
    Vec3 position = Vec3::Zero();
    Index point = kNone;
  };

  static Side sideOf(const SoupTriangle& t, std::size_t k) {
    const Index a = t.corner[k];
    const Index b = t.corner[(k + 1) % 3];
    return {std::min(a, b), std::max(a, b)};
  }

  void markSide(const SoupTriangle& t, std::size_t k) {
    const FaceSurface& surface = *index_.surfaces[at(t.face)];
    const SideLabel& label = t.side[k];
    if (label.edge == kNone && surface.type() == SurfaceType::Plane) return;
    const Side side = sideOf(t, k);
    if (splits_.contains(side)) return;
    const std::size_t k1 = (k + 1) % 3;
    const Vec3& a = soup_.points[at(t.corner[k])];
    const Vec3& b = soup_.points[at(t.corner[k1])];
    const Vec3 middle = 0.5 * (a + b);
    const Eigen::Vector2d uv = 0.5 * (t.uv[k] + t.uv[k1]);
    const double tolerance = 1e-3 * deflection_;
    const double limit = kAllowed * deflection_;
    std::optional<Vec3> onCurve;
    if (label.edge != kNone) {
      onCurve = curvePoint(label.edge, 0.5 * (label.first + label.last));
      // Parameters that do not fit the points (loose tolerances) are no help.
      if (!onCurve || (*onCurve - middle).norm() > 0.5 * (b - a).norm()) return;
      if ((*onCurve - middle).norm() > limit) splits_[side].position = *onCurve;
      return;
    }
    const double miss = deviation(surface, middle, uv, tolerance);
    if (miss <= limit) return;
    const double ends = std::max(deviation(surface, a, t.uv[k], tolerance),
                                 deviation(surface, b, t.uv[k1], tolerance));
    if (miss - ends <= limit) return;
    const SurfaceFoot foot = surface.foot(middle, tolerance, uv);
    if (foot.converged && (foot.point - middle).norm() < 0.5 * (b - a).norm()) {
      splits_[side].position = foot.point;
    }
  }

  std::optional<Vec3> curvePoint(Index edge, double parameter) {
    std::optional<BRepAdaptor_Curve>& curve = curves_[at(edge)];
    if (!curve) {
      const TopoDS_Edge& e = TopoDS::Edge(index_.maps.edges(edge + 1));
      if (BRep_Tool::Degenerated(e)) return std::nullopt;
      curve.emplace(TopoDS::Edge(e.Oriented(TopAbs_FORWARD)));
    }
    return toVec3(curve->Value(parameter).XYZ());
  }

  // One corner of a triangle being cut, with the label of the side that starts there.
  struct Corner {
    Index point = kNone;
    Eigen::Vector2d uv = Eigen::Vector2d::Zero();
    SideLabel side;
  };

  void emit(const SoupTriangle& parent, const Corner& a, const Corner& b, const Corner& c,
            const std::array<SideLabel, 3>& sides) {
    SoupTriangle t = parent;
    t.corner = {a.point, b.point, c.point};
    t.uv = {a.uv, b.uv, c.uv};
    t.side = sides;
    soup_.triangles.push_back(t);
  }

  void cut(const SoupTriangle& t) {
    std::vector<Corner> ring;  // corners and middles, in order
    std::array<std::size_t, 3> cornerAt{};
    for (std::size_t k = 0; k < 3; ++k) {
      cornerAt[k] = ring.size();
      ring.push_back({t.corner[k], t.uv[k], t.side[k]});
      const auto split = splits_.find(sideOf(t, k));
      if (split == splits_.end()) continue;
      const std::size_t k1 = (k + 1) % 3;
      const Eigen::Vector2d uv = 0.5 * (t.uv[k] + t.uv[k1]);
      const SurfaceFoot foot =
          index_.surfaces[at(t.face)]->foot(split->second.position, 1e-3 * deflection_, uv);
      const double middle = 0.5 * (t.side[k].first + t.side[k].last);
      ring.back().side.last = middle;
      ring.push_back({split->second.point,
                      foot.converged ? foot.uv : uv,
                      {t.side[k].edge, middle, t.side[k].last}});
    }
    const std::size_t n = ring.size();
    if (n == 3) {
      soup_.triangles.push_back(t);
      return;
    }
    // Cut off a corner between two middles while there is one, then fan what is left.
    if (n == 6) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t c = cornerAt[k];
        const Corner& before = ring[(c + n - 1) % n];
        emit(t, before, ring[c], ring[(c + 1) % n], {before.side, ring[c].side, SideLabel{}});
      }
      emit(t, ring[1], ring[3], ring[5], {});
      return;
    }
    std::size_t apex = 0;  // a middle, so that no triangle of the fan is flat
    while (std::find(cornerAt.begin(), cornerAt.end(), apex) != cornerAt.end()) ++apex;
    for (std::size_t i = 1; i + 1 < n; ++i) {
      const Corner& a = ring[apex];
      const Corner& b = ring[(apex + i) % n];
      const Corner& c = ring[(apex + i + 1) % n];
      const SideLabel none;
      emit(t, a, b, c, {i == 1 ? a.side : none, b.side, i + 2 == n ? c.side : none});
    }
  }

  Soup& soup_;
  const ShapeIndex& index_;
  double deflection_;
  std::map<Side, Split> splits_;
  std::vector<std::optional<BRepAdaptor_Curve>> curves_;
};

}  // namespace

double deviation(const FaceSurface& surface, const Vec3& x, const Eigen::Vector2d& uv,
                 double tolerance) {
  // First order where that is good enough: the tangent plane at the corresponding parameters. Where
  // parameters and point lie far apart (patches, apices, uneven parametrisations), a foot.
  Vec3 point, normal;
  if (!surface.analytic() && surface.pointAndNormal(uv, point, normal)) {
    const double height = std::abs(normal.dot(x - point));
    if ((x - point).norm() <= std::max(kTangentRatio * height, tolerance)) return height;
  }
  const SurfaceFoot foot = surface.foot(x, tolerance, uv);
  return foot.converged ? (x - foot.point).norm() : 0;
}

void refine(Soup& soup, const ShapeIndex& index, double deflection) {
  Refiner refiner(soup, index, deflection);
  for (int i = 0; i < kRounds && soup.triangles.size() < kMaxTriangles; ++i) {
    if (!refiner.round()) break;
  }
}

}  // namespace phront::cad
