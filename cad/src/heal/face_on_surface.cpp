// Parameter curves come by projection: straight where they are straight, interpolated else, always
// with their distance from the 3D curve measured.
#include "heal/face_on_surface.h"

#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <ElSLib.hxx>
#include <Precision.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>
#include <vector>

#include "exchange/tolerances.h"
#include "heal/face_samples.h"
#include "heal/free_angle.h"
#include "patches/patch_tools.h"

namespace phront::cad {
namespace {

// Points a parameter curve is interpolated through.
constexpr int kCurvePoints = 33;
// Between two of them an edge turns about the new surface's axis by less than this (rad), unless it
// runs through a pole or the seam.
constexpr double kMostTurn = 1;

double nearest(double angle, double to) {
  return angle + 2 * M_PI * std::round((to - angle) / (2 * M_PI));
}

class FaceMaker {
 public:
  FaceMaker(const TopoDS_Face& old, const Handle(Geom_Surface) & surface, double tolerance)
      : old_(TopoDS::Face(old.Oriented(TopAbs_FORWARD))),
        adaptor_(surface),
        middle_(middleOf(old_, adaptor_)),
        tolerance_(tolerance) {
    BRep_Builder().MakeFace(face_, surface, Precision::Confusion());
  }

  TopoDS_Face make(bool turned, const RenewedEdges& edges) {
    const BRep_Builder builder;
    for (TopoDS_Iterator w(old_); w.More(); w.Next()) {
      if (w.Value().ShapeType() != TopAbs_WIRE) continue;
      TopoDS_Wire wire;
      builder.MakeWire(wire);
      std::vector<TopoDS_Vertex> apexes;
      for (TopoDS_Iterator e(w.Value()); e.More(); e.Next()) {
        const TopoDS_Edge& edge = TopoDS::Edge(e.Value());
        if (BRep_Tool::Degenerated(edge)) {
          apexes.push_back(TopExp::FirstVertex(edge));
          continue;
        }
        const auto known = edges.find(edge.TShape().get());
        TopoDS_Edge used =
            known == edges.end() ? edge : TopoDS::Edge(known->second.Oriented(edge.Orientation()));
        addCurve(used);
        builder.Add(wire, used);
      }
      for (const TopoDS_Vertex& apex : apexes)
        if (isApex(adaptor_, BRep_Tool::Pnt(apex), tolerance_)) closeAtApex(wire, apex);
      wire.Closed(w.Value().Closed());
      builder.Add(face_, turned ? wire.Reversed() : TopoDS_Shape(wire));
    }
    BRepTools::Update(face_);
    return face_;
  }

 private:
  /// Adds the degenerated edge between the two edges of the wire that meet at the apex.
  void closeAtApex(TopoDS_Wire& wire, const TopoDS_Vertex& apex) const {
    gp_Pnt2d from;
    gp_Pnt2d to;
    for (TopoDS_Iterator it(wire); it.More(); it.Next()) {
      const TopoDS_Edge& edge = TopoDS::Edge(it.Value());
      gp_Pnt2d first;
      gp_Pnt2d last;
      BRep_Tool::UVPoints(edge, face_, first, last);
      if (edge.Orientation() == TopAbs_REVERSED) std::swap(first, last);
      if (TopExp::LastVertex(edge, Standard_True).IsSame(apex)) from = last;
      if (TopExp::FirstVertex(edge, Standard_True).IsSame(apex)) to = first;
    }
    const BRep_Builder builder;
    TopoDS_Edge edge;
    builder.MakeEdge(edge);
    builder.Add(edge, apex.Oriented(TopAbs_FORWARD));
    builder.Add(edge, apex.Oriented(TopAbs_REVERSED));
    const double length = from.Distance(to);
    builder.UpdateEdge(edge, straightPcurve(from, to, 0, length), face_, Precision::Confusion());
    builder.Range(edge, face_, 0, length);
    builder.Degenerated(edge, Standard_True);
    builder.Add(wire, edge);
  }

  /// Where the face lies in the periods of its new surface.
  static gp_Pnt2d middleOf(const TopoDS_Face& face, const GeomAdaptor_Surface& surface) {
    std::vector<double> u;
    std::vector<double> v;
    for (const SurfacePoint& s : samplesOf(face)) {
      const gp_Pnt2d uv = parametersOn(surface, gp_Pnt(s.point.x(), s.point.y(), s.point.z()));
      u.push_back(uv.X());
      v.push_back(uv.Y());
    }
    return {std::remainder(widestFreeAngle(std::move(u)).middle, 2 * M_PI) + M_PI,
            std::remainder(widestFreeAngle(std::move(v)).middle, 2 * M_PI) + M_PI};
  }

  void addCurve(const TopoDS_Edge& use) const {
    const TopoDS_Edge edge = TopoDS::Edge(use.Oriented(TopAbs_FORWARD));
    if (adaptor_.GetType() == GeomAbs_Plane) {  // needs none
      raiseTolerance(edge, face_);
      return;
    }
    double first = 0;
    double last = 0;
    TopLoc_Location location;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, location, first, last);
    if (curve.IsNull()) throw Standard_Failure("an edge without a curve");
    std::vector<gp_Pnt2d> points;
    std::vector<double> at;
    std::vector<std::size_t> atApex;
    for (int i = 0; i < kCurvePoints; ++i) {
      const double t = first + (last - first) * i / (kCurvePoints - 1);
      const gp_Pnt p = curve->Value(t).Transformed(location.Transformation());
      if (isApex(adaptor_, p, tolerance_)) atApex.push_back(points.size());
      gp_Pnt2d uv = parametersOn(adaptor_, p);
      uv.SetX(nearest(uv.X(), middle_.X()));
      if (adaptor_.GetType() == GeomAbs_Torus) uv.SetY(nearest(uv.Y(), middle_.Y()));
      points.push_back(uv);
      at.push_back(t);
    }
    // An edge comes to the apex at its own angle.
    for (const std::size_t i : atApex) points[i].SetX(points[i == 0 ? 1 : i - 1].X());
    for (std::size_t i = 1; i < points.size(); ++i)
      if (std::abs(points[i].X() - points[i - 1].X()) > kMostTurn)
        throw Standard_Failure("an edge through a pole or across the seam");
    const BRep_Builder builder;
    builder.UpdateEdge(edge, curveThrough(points, at), face_, Precision::Confusion());
    builder.Range(edge, face_, first, last);
    raiseTolerance(edge, face_);
  }

  static Handle(Geom2d_Curve)
      curveThrough(const std::vector<gp_Pnt2d>& points, const std::vector<double>& at) {
    const gp_Pnt2d& a = points.front();
    const gp_Pnt2d& b = points.back();
    const double first = at.front();
    const double last = at.back();
    double off = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double s = (at[i] - first) / (last - first);
      const gp_Pnt2d straight(a.XY() + s * (b.XY() - a.XY()));
      off = std::max(off, straight.Distance(points[i]));
    }
    constexpr double kStraight = 1e-9;
    if (off <= kStraight * std::max(1.0, a.Distance(b))) return straightPcurve(a, b, first, last);
    return pcurveThrough(points, at);
  }

  TopoDS_Face old_;
  GeomAdaptor_Surface adaptor_;
  gp_Pnt2d middle_;
  double tolerance_;
  TopoDS_Face face_;
};

}  // namespace

gp_Pnt2d parametersOn(const GeomAdaptor_Surface& surface, const gp_Pnt& p) {
  double u = 0;
  double v = 0;
  switch (surface.GetType()) {
    case GeomAbs_Plane:
      ElSLib::Parameters(surface.Plane(), p, u, v);
      break;
    case GeomAbs_Cylinder:
      ElSLib::Parameters(surface.Cylinder(), p, u, v);
      break;
    case GeomAbs_Cone:
      ElSLib::Parameters(surface.Cone(), p, u, v);
      break;
    case GeomAbs_Sphere:
      ElSLib::Parameters(surface.Sphere(), p, u, v);
      break;
    default:
      ElSLib::Parameters(surface.Torus(), p, u, v);
      break;
  }
  return {u, v};
}

bool isApex(const GeomAdaptor_Surface& surface, const gp_Pnt& p, double tolerance) {
  return surface.GetType() == GeomAbs_Cone && surface.Cone().Apex().Distance(p) <= tolerance;
}

TopoDS_Face faceOnSurface(const TopoDS_Face& old, const Handle(Geom_Surface) & surface, bool turned,
                          const RenewedEdges& edges, double tolerance) {
  return FaceMaker(old, surface, tolerance).make(turned, edges);
}

}  // namespace phront::cad
