// Every edge of a patch carries its exact 3D curve first (line, circle, image of a parameter
// curve); the parameter curve on a new face is then a straight segment over the same range, and the
// distance between the two is measured and written into the tolerances instead of being assumed.
#include "patches/patch_tools.h"
#include "exchange/tolerances.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Copy.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Geom2dAPI_Interpolate.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_Line.hxx>
#include <GeomLib_IsPlanarSurface.hxx>
#include <Geom_Circle.hxx>
#include <Geom_Line.hxx>
#include <Poly_Triangulation.hxx>
#include <Precision.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_HArray1OfReal.hxx>
#include <TColgp_Array1OfPnt2d.hxx>
#include <TColgp_HArray1OfPnt2d.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Ax2.hxx>

namespace phront::cad {
namespace {

/// rad; arcs that are meant to be all but a whole turn do not occur.
constexpr double kAlmostNone = 0.05;
/// Share of the parameter box by which a singular point is left; 1e-3 was seen to spoil the merging
/// of vertices, 1e-7 not.
constexpr double kNudge = 1e-7;

std::optional<gp_Vec> rawNormal(const BRepAdaptor_Surface& surface, double u, double v) {
  gp_Pnt p;
  gp_Vec du;
  gp_Vec dv;
  surface.D1(u, v, p, du, dv);
  const gp_Vec n = du.Crossed(dv);
  // Singular where the two derivatives vanish or are parallel.
  if (n.Magnitude() <= 1e-9 * std::max({du.SquareMagnitude(), dv.SquareMagnitude(), 1e-30})) {
    return std::nullopt;
  }
  return n.Normalized();
}

/// The axis asked for, turned as little as makes the arc pass both ends: tangents of badly drawn
/// edges are not perpendicular to the normals of their faces.
gp_Vec arcAxis(const gp_Vec& axis, const gp_Vec& x, const gp_Vec& toB) {
  constexpr double kPlane = 0.1;  // rad, between the arms: they tell the plane
  const gp_Vec across = axis - x * (axis.Dot(x) / x.SquareMagnitude());
  const gp_Vec normal = x.Crossed(toB);
  if (normal.Magnitude() < kPlane * x.Magnitude() * toB.Magnitude()) return across;
  return normal.Dot(axis) < 0 ? normal.Reversed() : normal;
}

double signedArea(const std::vector<PatchSide>& sides, const std::vector<bool>& reversed) {
  double twice = 0;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const gp_Pnt2d& a = reversed[i] ? sides[i].last : sides[i].first;
    const gp_Pnt2d& b = reversed[i] ? sides[i].first : sides[i].last;
    twice += a.X() * b.Y() - a.Y() * b.X();
  }
  return twice / 2;
}

}  // namespace

Handle(Geom2d_Curve)
    straightPcurve(const gp_Pnt2d& a, const gp_Pnt2d& b, double first, double last) {
  const double length = a.Distance(b);
  if (std::abs(length - (last - first)) <= 1e-12 * std::max(1.0, length) && length > 0) {
    const gp_Dir2d direction(b.X() - a.X(), b.Y() - a.Y());
    const gp_Vec2d back(direction);
    return new Geom2d_Line(a.Translated(back * -first), direction);
  }
  TColgp_Array1OfPnt2d poles(1, 2);
  poles(1) = a;
  poles(2) = b;
  TColStd_Array1OfReal knots(1, 2);
  knots(1) = first;
  knots(2) = last;
  TColStd_Array1OfInteger multiplicities(1, 2);
  multiplicities(1) = 2;
  multiplicities(2) = 2;
  return new Geom2d_BSplineCurve(poles, knots, multiplicities, 1);
}

Handle(Geom2d_Curve)
    pcurveThrough(const std::vector<gp_Pnt2d>& points, const std::vector<double>& parameters) {
  const auto count = static_cast<int>(points.size());
  const Handle(TColgp_HArray1OfPnt2d) at = new TColgp_HArray1OfPnt2d(1, count);
  const Handle(TColStd_HArray1OfReal) t = new TColStd_HArray1OfReal(1, count);
  for (int i = 0; i < count; ++i) {
    at->SetValue(i + 1, points[static_cast<std::size_t>(i)]);
    t->SetValue(i + 1, parameters[static_cast<std::size_t>(i)]);
  }
  Geom2dAPI_Interpolate interpolation(at, t, Standard_False, 1e-12);
  interpolation.Perform();
  return Handle(Geom2d_Curve)(interpolation.Curve());
}

std::optional<gp_Vec> outwardNormal(const TopoDS_Face& face, const gp_Pnt2d& uv) {
  const BRepAdaptor_Surface surface(face, Standard_False);
  std::optional<gp_Vec> n = rawNormal(surface, uv.X(), uv.Y());
  if (!n) {
    double u0 = 0;
    double u1 = 0;
    double v0 = 0;
    double v1 = 0;
    BRepTools::UVBounds(face, u0, u1, v0, v1);
    const double u = uv.X() + kNudge * ((u0 + u1) / 2 - uv.X());
    const double v = uv.Y() + kNudge * ((v0 + v1) / 2 - uv.Y());
    n = rawNormal(surface, u, v);
  }
  if (n && face.Orientation() == TopAbs_REVERSED) n->Reverse();
  return n;
}

std::vector<TopoDS_Edge> edgesOf(const TopoDS_Face& face) {
  std::vector<TopoDS_Edge> edges;
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    edges.push_back(TopoDS::Edge(it.Current()));
  }
  return edges;
}

TopoDS_Vertex poleOf(const TopoDS_Face& face) {
  for (const TopoDS_Edge& edge : edgesOf(face))
    if (BRep_Tool::Degenerated(edge)) return TopExp::FirstVertex(edge);
  return {};
}

double diagonalOf(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box, Standard_False);
  return box.IsVoid() ? 0 : std::sqrt(box.SquareExtent());
}

bool isPlanar(const TopoDS_Face& face, double diagonal) {
  constexpr double kPlanarity = 1e-6;
  return GeomLib_IsPlanarSurface(BRep_Tool::Surface(face), kPlanarity * diagonal).IsPlanar();
}

bool tessellates(const TopoDS_Face& face, double size) {
  constexpr double kDeflection = 0.02;  // of the size
  constexpr double kAngle = 0.3;
  // Of a copy: triangulations stay with the face, and with its edges.
  const TopoDS_Face copy = TopoDS::Face(BRepBuilderAPI_Copy(face, Standard_False).Shape());
  const BRepMesh_IncrementalMesh mesher(copy, kDeflection * size, Standard_False, kAngle,
                                        Standard_False);
  TopLoc_Location location;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(copy, location);
  return !mesh.IsNull() && mesh->NbTriangles() > 0;
}

TopoDS_Vertex makeVertex(const gp_Pnt& point, double tolerance) {
  TopoDS_Vertex vertex;
  BRep_Builder().MakeVertex(vertex, point, tolerance);
  return vertex;
}

TopoDS_Vertex PointPool::at(const gp_Pnt& point, double tolerance) {
  for (const TopoDS_Vertex& vertex : vertices_) {
    if (BRep_Tool::Pnt(vertex).Distance(point) < tolerance) return vertex;
  }
  vertices_.push_back(makeVertex(point, Precision::Confusion()));
  return vertices_.back();
}

TopoDS_Edge ArcPool::arc(const gp_Pnt& centre, const gp_Vec& axis, double radius,
                         const TopoDS_Vertex& from, const TopoDS_Vertex& to) {
  const gp_Vec x(centre, BRep_Tool::Pnt(from));
  const gp_Vec toB(centre, BRep_Tool::Pnt(to));
  const gp_Vec turn = arcAxis(axis, x, toB);
  const gp_Vec y = turn.Crossed(x).Normalized();
  double angle = std::atan2(toB.Dot(y), toB.Dot(x.Normalized()));
  // Between vertices that almost coincide it is round-off which of them comes first.
  const bool backward = angle < 0 && angle > -kAlmostNone;
  if (backward) angle = -angle;
  if (angle < 0) angle += 2 * M_PI;
  const gp_Ax2 frame(centre, gp_Dir(backward ? turn.Reversed() : turn), gp_Dir(x));
  const Handle(Geom_Circle) circle = new Geom_Circle(frame, radius);
  return shared(circle, angle, from, to);
}

TopoDS_Edge ArcPool::line(const TopoDS_Vertex& from, const TopoDS_Vertex& to) {
  const gp_Pnt a = BRep_Tool::Pnt(from);
  const gp_Vec along(a, BRep_Tool::Pnt(to));
  return shared(new Geom_Line(a, gp_Dir(along)), along.Magnitude(), from, to);
}

TopoDS_Edge ArcPool::shared(const Handle(Geom_Curve) & curve, double last,
                            const TopoDS_Vertex& from, const TopoDS_Vertex& to) {
  const gp_Pnt start = curve->Value(0);
  const gp_Pnt end = curve->Value(last);
  const gp_Pnt middle = curve->Value(last / 2);
  // Two edges between the same vertices are one when their middles agree within a thousandth.
  const double size = start.Distance(middle) + middle.Distance(end);
  Key key(from.TShape().get(), to.TShape().get());
  if (key.second < key.first) std::swap(key.first, key.second);
  for (const Entry& entry : arcs_[key]) {
    if (entry.middle.Distance(middle) < 1e-3 * size) return entry.edge;
  }
  const BRep_Builder builder;
  TopoDS_Edge edge;
  builder.MakeEdge(edge, curve, Precision::Confusion());
  builder.Add(edge, from.Oriented(TopAbs_FORWARD));
  builder.Add(edge, to.Oriented(TopAbs_REVERSED));
  builder.Range(edge, 0, last);
  const double gap =
      std::max(start.Distance(BRep_Tool::Pnt(from)), end.Distance(BRep_Tool::Pnt(to)));
  builder.UpdateVertex(from, std::max(1.1 * gap, Precision::Confusion()));
  builder.UpdateVertex(to, std::max(1.1 * gap, Precision::Confusion()));
  arcs_[key].push_back({edge, middle});
  return edge;
}

TopoDS_Face faceFromSides(const Handle(Geom_Surface) & surface, const std::vector<PatchSide>& sides,
                          double tolerance) {
  const BRep_Builder builder;
  TopoDS_Face face;
  builder.MakeFace(face, surface, tolerance);

  // Sides are chained by their corners in (u,v): a side is reversed when its last corner is nearer
  // to the end of the side before.
  std::vector<bool> reversed(sides.size(), false);
  if (sides.size() > 1) {
    const auto meets = [](const gp_Pnt2d& p, const PatchSide& s) {
      return std::min(p.Distance(s.first), p.Distance(s.last));
    };
    reversed[0] = meets(sides[0].first, sides[1]) < meets(sides[0].last, sides[1]);
    for (std::size_t i = 1; i < sides.size(); ++i) {
      const gp_Pnt2d& end = reversed[i - 1] ? sides[i - 1].first : sides[i - 1].last;
      reversed[i] = end.Distance(sides[i].last) < end.Distance(sides[i].first);
    }
  }
  const bool clockwise = signedArea(sides, reversed) < 0;

  std::vector<TopoDS_Edge> ordered;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const PatchSide& side = sides[i];
    TopoDS_Edge edge = TopoDS::Edge(side.edge.Oriented(TopAbs_FORWARD));
    double first = 0;
    double last = side.first.Distance(side.last);
    if (side.degenerated) {
      builder.MakeEdge(edge);
      builder.Degenerated(edge, Standard_True);
      builder.Add(edge, side.pole.Oriented(TopAbs_FORWARD));
      builder.Add(edge, side.pole.Oriented(TopAbs_REVERSED));
    } else {
      BRep_Tool::Range(edge, first, last);
    }
    const Handle(Geom2d_Curve) curve =
        side.curve.IsNull() ? straightPcurve(side.first, side.last, first, last) : side.curve;
    builder.UpdateEdge(edge, curve, face, tolerance);
    builder.Range(edge, face, first, last);
    if (side.degenerated)
      builder.Range(edge, first, last);
    else
      raiseTolerance(edge, face);
    ordered.push_back(TopoDS::Edge(reversed[i] ? edge.Reversed() : edge));
  }
  TopoDS_Wire wire;
  builder.MakeWire(wire);
  if (clockwise) {
    for (auto it = ordered.rbegin(); it != ordered.rend(); ++it) builder.Add(wire, it->Reversed());
  } else {
    for (const TopoDS_Edge& edge : ordered) builder.Add(wire, edge);
  }
  wire.Closed(Standard_True);
  builder.Add(face, wire);
  BRepTools::Update(face);
  return face;
}

}  // namespace phront::cad
