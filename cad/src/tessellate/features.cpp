// Edge types by the signed dihedral angle.
//
// Along an edge the outward normals n1, n2 of its two faces are compared at several parameters.
// With t the edge's direction as face 1 runs it, m1 = n1 x t points into face 1; the edge is convex
// where n2 leans away from m1. Normals come from the parameter curves, i.e. from the exact
// surfaces; where a surface is singular the sample moves a little towards the middle of the edge.
#include "tessellate/features.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>

namespace phront::cad {
namespace {

constexpr int kEdgeSamples = 11;    // interior and ends; types rarely change between two of these
constexpr double kEndInset = 1e-3;  // of the range: pcurves of trimmed ends are least accurate

struct DihedralRange {
  double convex = 0;  // rad, largest
  double concave = 0;
  bool known = false;
};

// Normal of the face of a use at a curve parameter.
bool normalAt(const ShapeIndex& index, const EdgeUse& use, double parameter, Vec3& normal) {
  double first = 0;
  double last = 0;
  const Handle(Geom2d_Curve) pcurve = BRep_Tool::CurveOnSurface(use.edge, use.face, first, last);
  if (pcurve.IsNull()) return false;
  const gp_Pnt2d uv = pcurve->Value(std::clamp(parameter, first, last));
  Vec3 point;
  return index.surfaces[static_cast<std::size_t>(use.faceIndex)]->pointAndNormal({uv.X(), uv.Y()},
                                                                                 point, normal);
}

DihedralRange dihedralRange(const ShapeIndex& index, const EdgeUse& a, const EdgeUse& b) {
  DihedralRange range;
  double first = 0;
  double last = 0;
  if (BRep_Tool::Curve(a.edge, first, last).IsNull()) return range;
  const BRepAdaptor_Curve curve(a.edge);
  for (int k = 0; k < kEdgeSamples; ++k) {
    const double s = kEndInset + (1 - 2 * kEndInset) * k / (kEdgeSamples - 1.0);
    const double parameter = first + s * (last - first);
    Vec3 n1, n2;
    if (!normalAt(index, a, parameter, n1) || !normalAt(index, b, parameter, n2)) continue;
    gp_Pnt p;
    gp_Vec d;
    curve.D1(parameter, p, d);
    Vec3 t = toVec3(d.XYZ());
    if (!(t.norm() > 0)) continue;
    t.normalize();
    if (a.edge.Orientation() == TopAbs_REVERSED) t = -t;
    if (index.surfaces[static_cast<std::size_t>(a.faceIndex)]->mirrored()) t = -t;
    const double angle = std::atan2(n1.cross(n2).norm(), n1.dot(n2));
    const bool convex = n2.dot(n1.cross(t)) < 0;
    (convex ? range.convex : range.concave) =
        std::max(convex ? range.convex : range.concave, angle);
    range.known = true;
  }
  return range;
}

// Largest angle between normals along a degenerated edge: large at a cone's apex, none at the pole
// of a sphere.
double apexAngle(const ShapeIndex& index, const EdgeUse& use) {
  double first = 0;
  double last = 0;
  const Handle(Geom2d_Curve) pcurve = BRep_Tool::CurveOnSurface(use.edge, use.face, first, last);
  if (pcurve.IsNull()) return 0;
  const FaceSurface& surface = *index.surfaces[static_cast<std::size_t>(use.faceIndex)];
  const BRepAdaptor_Surface bounds(use.face, Standard_True);
  const Eigen::Vector2d middle(0.5 * (bounds.FirstUParameter() + bounds.LastUParameter()),
                               0.5 * (bounds.FirstVParameter() + bounds.LastVParameter()));
  constexpr double kInset = 1e-6;  // of the way into the face; small against any real curvature
  std::vector<Vec3> normals;
  for (int k = 0; k < kEdgeSamples; ++k) {
    const gp_Pnt2d on = pcurve->Value(first + (last - first) * k / (kEdgeSamples - 1.0));
    const Eigen::Vector2d border(on.X(), on.Y());
    // Step into the face only across the degenerated side, not along it.
    Eigen::Vector2d uv = border;
    const bool alongU = std::abs(pcurve->Value(last).X() - pcurve->Value(first).X()) >
                        std::abs(pcurve->Value(last).Y() - pcurve->Value(first).Y());
    const int across = alongU ? 1 : 0;
    uv[across] += kInset * (middle[across] - border[across]);
    Vec3 p, n;
    gp_Pnt point;
    gp_Vec du, dv;
    surface.adaptor().D1(uv.x(), uv.y(), point, du, dv);
    const Vec3 cross = toVec3(du.Crossed(dv).XYZ());
    if (cross.norm() > 0) normals.push_back(cross.normalized());
  }
  double angle = 0;
  for (const Vec3& a : normals) {
    for (const Vec3& b : normals)
      angle = std::max(angle, std::acos(std::clamp(a.dot(b), -1.0, 1.0)));
  }
  return angle;
}

EdgeFeature edgeFeature(const ShapeIndex& index, const std::vector<EdgeUse>& uses,
                        double smoothAngle) {
  EdgeFeature feature;
  for (const EdgeUse& use : uses) feature.faces.push_back(use.faceIndex);
  if (uses.empty() || BRep_Tool::Degenerated(uses.front().edge)) {
    feature.type = EdgeType::Smooth;
    return feature;
  }
  if (uses.size() != 2) {
    feature.type = uses.size() == 1 ? EdgeType::Free : EdgeType::NonManifold;
    return feature;
  }
  const DihedralRange range = dihedralRange(index, uses[0], uses[1]);
  feature.maxDihedral = std::max(range.convex, range.concave);
  if (feature.maxDihedral < smoothAngle) {
    feature.type = EdgeType::Smooth;
  } else if (range.convex >= smoothAngle && range.concave >= smoothAngle) {
    feature.type = EdgeType::Mixed;
  } else {
    feature.type = range.convex >= smoothAngle ? EdgeType::Convex : EdgeType::Concave;
  }
  return feature;
}

}  // namespace

ShapeIndex::ShapeIndex(const TopoDS_Shape& shape) : maps(shape) {
  surfaces.resize(static_cast<std::size_t>(maps.faces.Extent()));
  uses.resize(static_cast<std::size_t>(maps.edges.Extent()));
  for (TopExp_Explorer f(shape, TopAbs_FACE); f.More(); f.Next()) {
    const TopoDS_Face face = TopoDS::Face(f.Current());
    const Index faceIndex = maps.faces.FindIndex(face) - 1;
    auto& surface = surfaces[static_cast<std::size_t>(faceIndex)];
    if (!surface) surface = std::make_unique<FaceSurface>(face);
    for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next()) {
      const TopoDS_Edge edge = TopoDS::Edge(e.Current());
      if (edge.Orientation() != TopAbs_FORWARD && edge.Orientation() != TopAbs_REVERSED) continue;
      uses[static_cast<std::size_t>(maps.edges.FindIndex(edge) - 1)].push_back(
          {face, edge, faceIndex});
    }
  }
}

ShapeFeatures shapeFeatures(const ShapeIndex& index, const FeatureOptions& options) {
  ShapeFeatures result;
  for (const auto& surface : index.surfaces) {
    FaceFeature face;
    face.type = surface->type();
    face.plane = surface->plane(options.planeTolerance);
    result.table.faces.push_back(std::move(face));
  }
  result.sharpVertex.assign(static_cast<std::size_t>(index.maps.vertices.Extent()), false);
  for (const std::vector<EdgeUse>& uses : index.uses) {
    EdgeFeature feature = edgeFeature(index, uses, options.smoothAngle);
    bool sharp = isSharp(feature.type) && !uses.empty();
    if (!uses.empty() && BRep_Tool::Degenerated(uses.front().edge)) {
      sharp = apexAngle(index, uses.front()) >= options.smoothAngle;
    }
    if (sharp) {
      for (TopExp_Explorer v(uses.front().edge, TopAbs_VERTEX); v.More(); v.Next()) {
        result
            .sharpVertex[static_cast<std::size_t>(index.maps.vertices.FindIndex(v.Current()) - 1)] =
            true;
      }
    }
    result.table.edges.push_back(std::move(feature));
  }
  for (int v = 1; v <= index.maps.vertices.Extent(); ++v) {
    result.table.vertices.push_back(
        {toVec3(BRep_Tool::Pnt(TopoDS::Vertex(index.maps.vertices(v))).XYZ())});
  }
  return result;
}

}  // namespace phront::cad
