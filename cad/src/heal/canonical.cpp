// General Fuse, distances and facets are fast and exact on elementary surfaces and slow or lost on
// B-splines that look the same; many systems write nothing but B-splines.
//
// Each face is sampled inside and along its border and fitted. A recognised face keeps its edges,
// which get new parameter curves by projection: straight where they are straight, interpolated
// else, always with their distance from the 3D curve measured. Where the new surface's own normal
// points to the other side, the wires are turned and the face is reversed. Edges change their 3D
// curve only where every face on them is elementary: a new curve would leave the pcurves on a
// freeform face wrong (parts were seen to change their volume by a third). Faces that come out
// badly are struck off and all is built again without them.
// A pole of the old surface is no pole of the new one, and its degenerated edge goes, but for the
// apex of a cone. Weak spots: a face with a seam is left alone (closed faces are divided before);
// ellipses stay B-splines.
#include "heal/canonical.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepBuilderAPI_Copy.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepTools.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <ElSLib.hxx>
#include <Geom_Circle.hxx>
#include <Geom_Line.hxx>
#include <Precision.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TopAbs.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "exchange/measures.h"
#include "exchange/tolerances.h"
#include "heal/elementary_fit.h"
#include "heal/free_angle.h"
#include "patches/patch_tools.h"

namespace phront::cad {
namespace {

// Samples per knot span and per direction; a B-spline may leave its primitive inside one span.
constexpr int kPerSpan = 4;
constexpr int kMostPerDirection = 24;
constexpr int kPerEdge = 9;
// Points a parameter curve is interpolated through.
constexpr int kCurvePoints = 33;
// Between two of them an edge turns about the new surface's axis by less than this (rad), unless it
// runs through a pole or the seam.
constexpr double kMostTurn = 1;
// Relative change of a face's area that a new surface may make.
constexpr double kAreaChange = 1e-4;
constexpr int kRounds = 4;
// Cones nearer than this (rad) to a cylinder or a plane are one or the other by all that can be
// measured on a part. Their apex is far outside or their rulings have no direction, and the
// intersection of two such is lost in round-off (seen: a half-angle of 1e-4, the apex 190 km away).
constexpr double kLeastConicAngle = 1e-3;

using CurveOnFace = Handle(Geom2d_Curve);

Vec3 toVec(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }

/// The vertex of the first degenerated edge; null without one.
TopoDS_Vertex poleOf(const TopoDS_Face& face) {
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
    if (BRep_Tool::Degenerated(edge)) return TopExp::FirstVertex(edge);
  }
  return {};
}

bool hasPole(const TopoDS_Face& face) { return !poleOf(face).IsNull(); }

bool hasSeam(const TopoDS_Face& face) {
  std::set<const void*> seen;
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    if (!seen.insert(it.Current().TShape().get()).second) return true;
  }
  return false;
}

std::vector<double> parameters(const BRepAdaptor_Surface& surface, bool alongU, double low,
                               double high) {
  std::vector<double> knots{low, high};
  const auto add = [&](const TColStd_Array1OfReal& all) {
    for (const double k : all) {
      if (k > low && k < high) knots.push_back(k);
    }
  };
  const GeomAbs_Shape order = GeomAbs_CN;
  const int count = alongU ? surface.NbUIntervals(order) : surface.NbVIntervals(order);
  TColStd_Array1OfReal intervals(1, count + 1);
  if (alongU)
    surface.UIntervals(intervals, order);
  else
    surface.VIntervals(intervals, order);
  add(intervals);
  std::sort(knots.begin(), knots.end());
  const auto spans = static_cast<int>(knots.size()) - 1;
  const int perSpan = std::max(1, std::min(kPerSpan, kMostPerDirection / spans));
  std::vector<double> result;
  for (int s = 0; s < spans; ++s) {
    for (int i = 0; i < perSpan; ++i) {
      result.push_back(knots[s] + (i + 0.5) / perSpan * (knots[s + 1] - knots[s]));
    }
  }
  return result;
}

/// Points of the face with the normals of its surface (not of its orientation).
std::vector<SurfacePoint> samplesOf(const TopoDS_Face& oriented) {
  const TopoDS_Face face = TopoDS::Face(oriented.Oriented(TopAbs_FORWARD));
  const BRepAdaptor_Surface surface(face, Standard_False);
  std::vector<SurfacePoint> points;
  const auto add = [&](const gp_Pnt2d& uv) {
    if (const std::optional<gp_Vec> n = outwardNormal(face, uv)) {
      points.push_back({toVec(surface.Value(uv.X(), uv.Y())), {n->X(), n->Y(), n->Z()}});
    }
  };
  const BRepTopAdaptor_FClass2d domain(face, Precision::PConfusion());
  double u0 = 0;
  double u1 = 0;
  double v0 = 0;
  double v1 = 0;
  BRepTools::UVBounds(face, u0, u1, v0, v1);
  for (const double u : parameters(surface, true, u0, u1)) {
    for (const double v : parameters(surface, false, v0, v1)) {
      if (domain.Perform(gp_Pnt2d(u, v)) == TopAbs_IN) add(gp_Pnt2d(u, v));
    }
  }
  for (const TopoDS_Edge& edge : edgesOf(face)) {
    if (BRep_Tool::Degenerated(edge)) continue;  // its neighbours have the pole, too
    double first = 0;
    double last = 0;
    const CurveOnFace curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
    for (int i = 0; i < kPerEdge && !curve.IsNull(); ++i) {
      add(curve->Value(first + (last - first) * i / (kPerEdge - 1)));
    }
  }
  return points;
}

/// Line or circle through the edge's ends; nullopt when it is neither within `tolerance`.
/// `last`: its last parameter, the first is 0; `off`: how far it is off the edge.
std::optional<Handle(Geom_Curve)> recogniseCurve(const TopoDS_Edge& edge, double tolerance,
                                                 double& last, double& off) {
  const BRepAdaptor_Curve curve(edge);
  if (curve.GetType() == GeomAbs_Line || curve.GetType() == GeomAbs_Circle) return std::nullopt;
  std::vector<gp_Pnt> points;
  const double t0 = curve.FirstParameter();
  const double t1 = curve.LastParameter();
  for (int i = 0; i < kCurvePoints; ++i) {
    points.push_back(curve.Value(t0 + (t1 - t0) * i / (kCurvePoints - 1)));
  }
  const gp_Pnt& a = points.front();
  const gp_Pnt& b = points.back();
  const gp_Pnt& middle = points[points.size() / 2];
  if (a.Distance(b) < 10 * tolerance) return std::nullopt;  // closed: edges are divided before
  const Handle(Geom_Line) line = new Geom_Line(a, gp_Dir(gp_Vec(a, b)));
  off = 0;
  for (const gp_Pnt& p : points) off = std::max(off, line->Lin().Distance(p));
  if (off <= tolerance) {
    last = a.Distance(b);
    return Handle(Geom_Curve)(line);
  }
  // Circle through the ends and the middle, which it keeps exactly.
  const gp_Vec p(middle, a);
  const gp_Vec q(middle, b);
  const gp_Vec n = p.Crossed(q);
  if (n.SquareMagnitude() < 1e-24) return std::nullopt;
  const gp_Vec arm =
      (q * p.SquareMagnitude() - p * q.SquareMagnitude()).Crossed(n) * (0.5 / n.SquareMagnitude());
  const gp_Pnt centre = middle.Translated(arm);
  const double radius = arm.Magnitude();
  // From a over the middle to b.
  const gp_Vec axis = gp_Vec(a, middle).Crossed(gp_Vec(middle, b));
  const gp_Ax2 frame(centre, gp_Dir(axis), gp_Dir(gp_Vec(centre, a)));
  const Handle(Geom_Circle) circle = new Geom_Circle(frame, radius);
  off = 0;
  for (const gp_Pnt& s : points) off = std::max(off, circle->Circ().Distance(s));
  if (off > tolerance) return std::nullopt;
  const gp_Vec toB(centre, b);
  last = std::atan2(toB.Dot(gp_Vec(frame.YDirection())), toB.Dot(gp_Vec(frame.XDirection())));
  if (last <= 0) last += 2 * M_PI;
  return Handle(Geom_Curve)(circle);
}

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

double nearest(double angle, double to) {
  return angle + 2 * M_PI * std::round((to - angle) / (2 * M_PI));
}

class Recogniser {
 public:
  Recogniser(const TopoDS_Shape& shape, double tolerance)
      : original_(shape), tolerance_(tolerance) {
    copyOriginal();
  }

  CanonicalShape run() {
    CanonicalShape result{original_};
    for (int f = 1; f <= faces_.Extent(); ++f) fit(f);
    for (int round = 0; round < kRounds && !fits_.empty(); ++round) {
      if (round > 0) copyOriginal();
      const std::set<int> bad = build();
      if (!bad.empty()) {
        for (const int f : bad) strikeOff(f);
        continue;
      }
      const TopoDS_Shape renewed = rebuilt(shape_);
      if (!BRepCheck_Analyzer(renewed).IsValid() && BRepCheck_Analyzer(original_).IsValid()) break;
      result.shape = renewed;
      result.edges = static_cast<int>(edges_.size());
      for (const auto& [f, fit] : fits_) {
        if (fit.alreadyElementary) continue;
        ++result.faces;
        result.deviation = std::max(result.deviation, fit.deviation);
      }
      break;
    }
    return result;
  }

 private:
  struct Fit {
    Handle(Geom_Surface) surface;
    double deviation = 0;
    bool turned = false;  ///< the new surface's own normal points to the other side
    bool alreadyElementary = false;
  };

  /// Parameter curves are added to edges: those of the input stay as they are.
  void copyOriginal() {
    shape_ = BRepBuilderAPI_Copy(original_).Shape();
    faces_.Clear();
    facesOfEdge_.Clear();
    TopExp::MapShapes(shape_, TopAbs_FACE, faces_);
    TopExp::MapShapesAndAncestors(shape_, TopAbs_EDGE, TopAbs_FACE, facesOfEdge_);
  }

  void fit(int f) {
    const TopoDS_Face face = TopoDS::Face(faces_(f));
    const BRepAdaptor_Surface surface(face, Standard_False);
    if (isElementary(surface)) {
      elementary_.insert(f);
      return;
    }
    try {
      if (hasSeam(face)) return;
      std::vector<SurfacePoint> points = samplesOf(face);
      std::optional<ElementaryFit> found = fitElementary(points, tolerance_);
      if (!found && hasPole(face)) found = fitUpToApex(face, points);
      if (!found) return;
      Fit fit{found->surface, found->deviation};
      const GeomAdaptor_Surface adaptor(fit.surface);
      const SurfacePoint& s = points[points.size() / 2];
      const gp_Pnt2d uv = parametersOn(adaptor, gp_Pnt(s.point.x(), s.point.y(), s.point.z()));
      gp_Pnt p;
      gp_Vec du;
      gp_Vec dv;
      adaptor.D1(uv.X(), uv.Y(), p, du, dv);
      fit.turned = du.Crossed(dv).Dot(gp_Vec(s.normal.x(), s.normal.y(), s.normal.z())) < 0;
      fits_[f] = fit;
      elementary_.insert(f);
    } catch (const Standard_Failure&) {
      return;  // stays what it is
    }
  }

  /// The cone whose apex is a pole of the face; takes the apex, where no normal is, out of
  /// `points`.
  std::optional<ElementaryFit> fitUpToApex(const TopoDS_Face& face,
                                           std::vector<SurfacePoint>& points) const {
    const TopoDS_Vertex pole = poleOf(face);
    const Vec3 apex = toVec(BRep_Tool::Pnt(pole));
    std::erase_if(points,
                  [&](const SurfacePoint& p) { return (p.point - apex).norm() < tolerance_; });
    std::optional<ElementaryFit> found = fitElementary(points, tolerance_);
    if (!found) return std::nullopt;
    const GeomAdaptor_Surface surface(found->surface);
    if (surface.GetType() != GeomAbs_Cone) return std::nullopt;
    if (!isApex(surface, BRep_Tool::Pnt(pole))) return std::nullopt;
    return found;
  }

  bool isApex(const GeomAdaptor_Surface& surface, const gp_Pnt& p) const {
    return surface.GetType() == GeomAbs_Cone && surface.Cone().Apex().Distance(p) <= tolerance_;
  }

  void strikeOff(int f) {
    if (!fits_.at(f).alreadyElementary) elementary_.erase(f);
    // An elementary face cannot be given back its old edges: keep its neighbours as they were.
    if (fits_.at(f).alreadyElementary) frozen_.insert(f);
    fits_.erase(f);
    for (auto it = fits_.begin(); it != fits_.end();) {
      it = it->second.alreadyElementary ? fits_.erase(it) : std::next(it);
    }
  }

  /// Makes edges and faces; returns the faces that come out badly.
  std::set<int> build() {
    edges_.clear();
    built_.clear();
    for (int e = 1; e <= facesOfEdge_.Extent(); ++e) renewEdge(e);
    std::set<int> bad;
    for (const auto& [f, fit] : fits_) {
      try {
        const TopoDS_Face face = TopoDS::Face(faces_(f));
        const TopoDS_Face renewed = renewFace(face, fit);
        const double area = accurateAreaOf(face);
        if (std::abs(accurateAreaOf(renewed) - area) > kAreaChange * area ||
            !BRepCheck_Analyzer(renewed).IsValid()) {
          bad.insert(f);
        }
        built_[f] = renewed;
      } catch (const Standard_Failure&) {
        bad.insert(f);
      }
    }
    return bad;
  }

  /// A line or circle instead of the edge, where all its faces allow it.
  void renewEdge(int e) {
    const TopoDS_Edge edge = TopoDS::Edge(facesOfEdge_.FindKey(e).Oriented(TopAbs_FORWARD));
    if (BRep_Tool::Degenerated(edge)) return;
    bool touched = false;
    bool all = true;
    for (const TopoDS_Shape& user : facesOfEdge_(e)) {
      const int f = faces_.FindIndex(user);
      touched = touched || (fits_.contains(f) && !fits_.at(f).alreadyElementary);
      all = all && elementary_.contains(f) && !frozen_.contains(f);
    }
    if (!touched || !all) return;
    double last = 0;
    double off = 0;
    const std::optional<Handle(Geom_Curve)> found = recogniseCurve(edge, tolerance_, last, off);
    if (!found) return;
    const Handle(Geom_Curve)& curve = *found;
    for (const TopoDS_Shape& user : facesOfEdge_(e)) {
      const TopoDS_Face& face = TopoDS::Face(user);
      if (hasSeam(face) || (hasPole(face) && !fits_.contains(faces_.FindIndex(face)))) return;
    }
    const BRep_Builder builder;
    TopoDS_Edge renewed;
    builder.MakeEdge(renewed, curve, std::max(1.1 * off, Precision::Confusion()));
    TopoDS_Vertex ends[2];
    TopExp::Vertices(edge, ends[0], ends[1]);
    builder.Add(renewed, ends[0].Oriented(TopAbs_FORWARD));
    builder.Add(renewed, ends[1].Oriented(TopAbs_REVERSED));
    builder.Range(renewed, 0, last);
    const double gap = std::max(curve->Value(0).Distance(BRep_Tool::Pnt(ends[0])),
                                curve->Value(last).Distance(BRep_Tool::Pnt(ends[1])));
    for (const TopoDS_Vertex& end : ends) {
      builder.UpdateVertex(end, std::max(1.1 * gap, BRep_Tool::Tolerance(end)));
    }
    edges_[edge.TShape().get()] = renewed;
    for (const TopoDS_Shape& user : facesOfEdge_(e)) {
      const int f = faces_.FindIndex(user);
      if (fits_.contains(f)) continue;
      Fit same;
      same.surface = BRep_Tool::Surface(TopoDS::Face(user));
      same.alreadyElementary = true;
      fits_[f] = same;
    }
  }

  TopoDS_Face renewFace(const TopoDS_Face& old, const Fit& fit) {
    const BRep_Builder builder;
    TopoDS_Face face;
    builder.MakeFace(face, fit.surface, Precision::Confusion());
    const TopoDS_Face forward = TopoDS::Face(old.Oriented(TopAbs_FORWARD));
    const gp_Pnt2d middle = middleOn(forward, fit);
    for (TopoDS_Iterator w(forward); w.More(); w.Next()) {
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
        const auto known = edges_.find(edge.TShape().get());
        TopoDS_Edge used =
            known == edges_.end() ? edge : TopoDS::Edge(known->second.Oriented(edge.Orientation()));
        addCurve(used, face, middle);
        builder.Add(wire, used);
      }
      const GeomAdaptor_Surface surface(fit.surface);
      for (const TopoDS_Vertex& apex : apexes)
        if (isApex(surface, BRep_Tool::Pnt(apex))) closeAtApex(wire, apex, face);
      wire.Closed(w.Value().Closed());
      builder.Add(face, fit.turned ? wire.Reversed() : TopoDS_Shape(wire));
    }
    BRepTools::Update(face);
    return face;
  }

  /// Adds the degenerated edge between the two edges of the wire that meet at the apex.
  static void closeAtApex(TopoDS_Wire& wire, const TopoDS_Vertex& apex, const TopoDS_Face& face) {
    gp_Pnt2d from;
    gp_Pnt2d to;
    for (TopoDS_Iterator it(wire); it.More(); it.Next()) {
      const TopoDS_Edge& edge = TopoDS::Edge(it.Value());
      gp_Pnt2d first;
      gp_Pnt2d last;
      BRep_Tool::UVPoints(edge, face, first, last);
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
    builder.UpdateEdge(edge, straightPcurve(from, to, 0, length), face, Precision::Confusion());
    builder.Range(edge, face, 0, length);
    builder.Degenerated(edge, Standard_True);
    builder.Add(wire, edge);
  }

  /// Where the face lies in the periods of its new surface.
  static gp_Pnt2d middleOn(const TopoDS_Face& face, const Fit& fit) {
    const GeomAdaptor_Surface surface(fit.surface);
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

  void addCurve(const TopoDS_Edge& use, const TopoDS_Face& face, const gp_Pnt2d& middle) {
    const TopoDS_Edge edge = TopoDS::Edge(use.Oriented(TopAbs_FORWARD));
    const GeomAdaptor_Surface surface(BRep_Tool::Surface(face));
    if (surface.GetType() == GeomAbs_Plane) {  // needs none
      raiseTolerance(edge, face);
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
      if (isApex(surface, p)) atApex.push_back(points.size());
      gp_Pnt2d uv = parametersOn(surface, p);
      uv.SetX(nearest(uv.X(), middle.X()));
      if (surface.GetType() == GeomAbs_Torus) uv.SetY(nearest(uv.Y(), middle.Y()));
      points.push_back(uv);
      at.push_back(t);
    }
    // An edge comes to the apex at its own angle.
    for (const std::size_t i : atApex) points[i].SetX(points[i == 0 ? 1 : i - 1].X());
    for (std::size_t i = 1; i < points.size(); ++i)
      if (std::abs(points[i].X() - points[i - 1].X()) > kMostTurn)
        throw Standard_Failure("an edge through a pole or across the seam");
    const BRep_Builder builder;
    builder.UpdateEdge(edge, curveThrough(points, at), face, Precision::Confusion());
    builder.Range(edge, face, first, last);
    raiseTolerance(edge, face);
  }

  static CurveOnFace curveThrough(const std::vector<gp_Pnt2d>& points,
                                  const std::vector<double>& at) {
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

  /// The shape with its renewed faces, all placements spelt out.
  TopoDS_Shape rebuilt(const TopoDS_Shape& shape) const {
    if (shape.ShapeType() == TopAbs_FACE) {
      const int f = faces_.FindIndex(shape);
      const auto renewed = built_.find(f);
      if (renewed == built_.end()) return shape;
      const TopAbs_Orientation turn = fits_.at(f).turned ? TopAbs_REVERSED : TopAbs_FORWARD;
      return renewed->second.Oriented(TopAbs::Compose(shape.Orientation(), turn));
    }
    const BRep_Builder builder;
    TopoDS_Shape copy = shape.EmptyCopied();
    copy.Location(TopLoc_Location());
    for (TopoDS_Iterator it(shape, Standard_False, Standard_True); it.More(); it.Next()) {
      builder.Add(copy, rebuilt(it.Value()));
    }
    if (shape.ShapeType() == TopAbs_SHELL) copy.Closed(shape.Closed());
    return copy;
  }

  TopoDS_Shape original_;
  TopoDS_Shape shape_;
  double tolerance_;
  TopTools_IndexedMapOfShape faces_;
  TopTools_IndexedDataMapOfShapeListOfShape facesOfEdge_;
  std::map<int, Fit> fits_;
  std::set<int> elementary_;
  std::set<int> frozen_;  ///< elementary as read, and not to be given new edges
  std::map<const void*, TopoDS_Edge> edges_;
  std::map<int, TopoDS_Face> built_;
};

}  // namespace

bool isElementary(const BRepAdaptor_Surface& surface) {
  switch (surface.GetType()) {
    case GeomAbs_Plane:
    case GeomAbs_Cylinder:
    case GeomAbs_Sphere:
    case GeomAbs_Torus:
      return true;
    case GeomAbs_Cone:
      return std::abs(std::remainder(surface.Cone().SemiAngle(), M_PI / 2)) > kLeastConicAngle;
    default:
      return false;
  }
}

CanonicalShape recogniseSurfaces(const TopoDS_Shape& shape, double tolerance) {
  return Recogniser(shape, tolerance).run();
}

}  // namespace phront::cad
