// The round parts of the true offset: arcs along edges, spherical triangles at vertices.
//
// The offset of a solid at distance d consists of p + d n(p) for face points, of arcs of radius |d|
// in the plane across every edge between the normals of its two faces, and of directions inside the
// cone of the face normals at every vertex (Rossignac & Requicha 1986). All are drawn, also those
// of concave edges: the caller drops what lies nearer than |d| to the rest of the input. Arcs
// follow great circles between the normals; cone directions are random positive combinations of the
// normals, which cover every direction of a convex cone and, of a mixed one, a superset.
// Weak spot: where two normals are opposite (a knife edge of angle zero) no arc is defined.
#include <BRepAdaptor_Curve.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <optional>

#include "judge/check_sampling.h"
#include "tessellate/face_surface.h"

namespace phront::cad {
namespace {

constexpr double kSmallestAngle = 1e-3;  // rad: below, the strip is narrower than |d| / 1000
constexpr double kLargestAngle = 3.1;    // rad: beyond, the great circle is ill-defined
constexpr int kProbes = 17;              // points along an edge for its length and angle
constexpr int kFewestPerEdge = 10;
constexpr int kMostPerEdge = 1500;
constexpr int kFewestNormals = 3;   // a cone with less is an arc and belongs to an edge
constexpr double kOpposite = 1e-6;  // normals that cancel to less name no direction

double angleBetween(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// One use of an edge by a face: the pcurve belongs to this use (a seam has two).
struct EdgeUse {
  TopoDS_Edge edge;
  TopoDS_Face face;
  std::size_t surface = 0;
};

std::optional<Vec3> normalAt(const FaceSurface& surface, const EdgeUse& use, double t) {
  double first = 0;
  double last = 0;
  const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(use.edge, use.face, first, last);
  if (curve.IsNull()) return std::nullopt;
  const gp_Pnt2d uv = curve->Value(std::clamp(t, first, last));
  Vec3 point;
  Vec3 normal;
  if (!surface.pointAndNormal({uv.X(), uv.Y()}, point, normal)) return std::nullopt;
  return normal;
}

Vec3 slerp(const Vec3& a, const Vec3& b, double angle, double s) {
  return (a * std::sin((1 - s) * angle) + b * std::sin(s * angle)).normalized();
}

struct Cone {
  Vec3 apex = Vec3::Zero();
  std::vector<Vec3> normals;
};

class Rounding {
 public:
  Rounding(double distance, const RoundingDensity& density, SampleRng& rng)
      : distance_(distance), density_(density), rng_(rng) {}

  void collect(const TopoDS_Shape& shape) {
    TopTools_IndexedMapOfShape edges;
    std::vector<std::vector<EdgeUse>> uses;
    for (TopExp_Explorer f(shape, TopAbs_FACE); f.More(); f.Next()) {
      const TopoDS_Face& face = TopoDS::Face(f.Current());
      surfaces_.emplace_back(face);
      for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next()) {
        const TopoDS_Edge& edge = TopoDS::Edge(e.Current());
        if (BRep_Tool::Degenerated(edge)) continue;
        const auto index = static_cast<std::size_t>(edges.Add(edge));
        if (uses.size() < index) uses.emplace_back();
        uses[index - 1].push_back({edge, face, surfaces_.size() - 1});
      }
    }
    for (const auto& usesOfEdge : uses) {
      if (usesOfEdge.size() < 2) continue;
      try {
        const BRepAdaptor_Curve curve(usesOfEdge[0].edge);
        addToCones(usesOfEdge, curve);
        addArcs(usesOfEdge, curve);
      } catch (const Standard_Failure&) {
        continue;  // an edge without a usable curve rounds nothing
      }
    }
    for (const Cone& cone : cones_) addCone(cone);
  }

  std::vector<OffsetCandidate> candidates;

 private:
  std::optional<Vec3> normal(const EdgeUse& use, double t) const {
    try {
      return normalAt(surfaces_[use.surface], use, t);
    } catch (const Standard_Failure&) {
      return std::nullopt;  // a broken pcurve: this edge says nothing here
    }
  }

  void addToCones(const std::vector<EdgeUse>& uses, const BRepAdaptor_Curve& curve) {
    for (const bool atEnd : {false, true}) {
      const double t = atEnd ? curve.LastParameter() : curve.FirstParameter();
      const TopoDS_Vertex vertex =
          atEnd ? TopExp::LastVertex(uses[0].edge) : TopExp::FirstVertex(uses[0].edge);
      if (vertex.IsNull()) continue;
      const auto index = static_cast<std::size_t>(vertices_.Add(vertex));
      if (cones_.size() < index) cones_.emplace_back();
      Cone& cone = cones_[index - 1];
      cone.apex = toVec3(curve.Value(t).XYZ());
      for (const EdgeUse& use : uses) {
        if (const auto n = normal(use, t)) {
          cone.normals.push_back(*n);
        }
      }
    }
  }

  void addArcs(const std::vector<EdgeUse>& uses, const BRepAdaptor_Curve& curve) {
    const double first = curve.FirstParameter();
    const double last = curve.LastParameter();
    double length = 0;
    double largest = 0;
    double sum = 0;
    int measured = 0;
    for (int i = 0; i < kProbes; ++i) {
      const double t = first + (last - first) * i / (kProbes - 1);
      if (i > 0) {
        const double before = first + (last - first) * (i - 1) / (kProbes - 1);
        length += curve.Value(t).Distance(curve.Value(before));
      }
      const auto a = normal(uses[0], t);
      const auto b = normal(uses[1], t);
      if (!a || !b) continue;
      const double angle = angleBetween(*a, *b);
      largest = std::max(largest, angle);
      sum += angle;
      ++measured;
    }
    if (measured == 0 || largest < kSmallestAngle) return;
    const double stripArea = length * sum / measured * std::abs(distance_);
    const int n = static_cast<int>(
        std::clamp<double>(density_.perArea * stripArea, kFewestPerEdge, kMostPerEdge));
    for (int i = 0; i < n; ++i) {
      const double t = first + (last - first) * (i + rng_()) / n;
      const double s = rng_();
      const auto a = normal(uses[0], t);
      const auto b = normal(uses[1], t);
      if (!a || !b) continue;
      const double angle = angleBetween(*a, *b);
      if (angle < 0.1 * kSmallestAngle || angle > kLargestAngle) continue;
      const Vec3 point = toVec3(curve.Value(t).XYZ());
      candidates.push_back({point + distance_ * slerp(*a, *b, angle, s), stripArea / n, true});
    }
  }

  void addCone(const Cone& cone) {
    if (cone.normals.size() < kFewestNormals) return;
    // An octant of the sphere has area pi d^2 / 2; a third of it is a usual corner after trimming.
    const double weight = 0.5 * distance_ * distance_ / density_.perVertex;
    for (int i = 0; i < density_.perVertex; ++i) {
      Vec3 direction = Vec3::Zero();
      for (const Vec3& normal : cone.normals) direction -= normal * std::log(1 - rng_());
      if (direction.norm() < kOpposite) continue;
      candidates.push_back({cone.apex + distance_ * direction.normalized(), weight, true});
    }
  }

  double distance_;
  const RoundingDensity& density_;
  SampleRng& rng_;
  std::vector<FaceSurface> surfaces_;
  TopTools_IndexedMapOfShape vertices_;
  std::vector<Cone> cones_;
};

}  // namespace

std::vector<OffsetCandidate> roundingCandidates(const TopoDS_Shape& shape, double distance,
                                                const RoundingDensity& density, SampleRng& rng) {
  Rounding rounding(distance, density, rng);
  rounding.collect(shape);
  return std::move(rounding.candidates);
}

}  // namespace phront::cad
