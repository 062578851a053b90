#include "surfaces/parameter_plane.h"

#include <BRepAlgoAPI_Splitter.hxx>
#include <BRepLib.hxx>
#include <BRepTools_WireExplorer.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom2dConvert.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <GeomAPI.hxx>
#include <GeomAPI_Interpolate.hxx>
#include <Geom_Line.hxx>
#include <Geom_Plane.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <Precision.hxx>
#include <TColgp_HArray1OfPnt.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Pln.hxx>

#include "exchange/tolerances.h"
#include "patches/patch_tools.h"

namespace phront::cad {
namespace {

constexpr double kSharpTurn = 0.12;  // rad
constexpr double kCornerSize = 4;    // chords: a sharp turn within is a corner
constexpr double kSamePoint = 0.01;  // chords
constexpr double kUneven = 8;        // lengths of segments: the longer cannot bend like the shorter
constexpr double kCorner = 0.5;      // rad between segments of a line: a corner
constexpr double kOpen = 1e-2;       // of the domain: a gap between edges that is none
constexpr int kLengthSamples = 8;    // along an edge, to see whether it is a point in space

gp_Pnt planePoint(const Vec2& x) { return {x[0], x[1], 0}; }

TopoDS_Edge plainEdge(const Handle(Geom_Curve) & curve, double first, double last,
                      const TopoDS_Vertex& from, const TopoDS_Vertex& to, double tolerance) {
  TopoDS_Edge edge;
  const BRep_Builder builder;
  builder.MakeEdge(edge, curve, tolerance);
  builder.Add(edge, from.Oriented(TopAbs_FORWARD));
  builder.Add(edge, to.Oriented(TopAbs_REVERSED));
  builder.Range(edge, first, last);
  return edge;
}

/// Straight, from a to b.
TopoDS_Edge straightEdge(const TopoDS_Vertex& from, const TopoDS_Vertex& to, double tolerance) {
  const gp_Pnt a = BRep_Tool::Pnt(from);
  const gp_Pnt b = BRep_Tool::Pnt(to);
  return plainEdge(new Geom_Line(a, gp_Dir(gp_Vec(a, b))), 0, a.Distance(b), from, to, tolerance);
}

/// A parameter curve in the plane, from its first to its last parameter.
Handle(Geom_Curve)
    scaled(const Handle(Geom2d_Curve) & curve, double first, double last, const Vec2& scale) {
  const Handle(Geom2d_Curve) part = new Geom2d_TrimmedCurve(curve, first, last);
  const Handle(Geom2d_BSplineCurve) spline = Geom2dConvert::CurveToBSplineCurve(part);
  for (int i = 1; i <= spline->NbPoles(); ++i) {
    const gp_Pnt2d pole = spline->Pole(i);
    spline->SetPole(i, gp_Pnt2d(pole.X() * scale[0], pole.Y() * scale[1]));
  }
  return GeomAPI::To3d(spline, gp_Pln());
}

Handle(Geom2d_Curve)
    unscaled(const Handle(Geom_Curve) & curve, double first, double last, const Vec2& scale) {
  const Handle(Geom2d_Curve) flat = GeomAPI::To2d(curve, gp_Pln());
  const Handle(Geom2d_BSplineCurve) spline =
      Geom2dConvert::CurveToBSplineCurve(new Geom2d_TrimmedCurve(flat, first, last));
  for (int i = 1; i <= spline->NbPoles(); ++i) {
    const gp_Pnt2d pole = spline->Pole(i);
    spline->SetPole(i, gp_Pnt2d(pole.X() / scale[0], pole.Y() / scale[1]));
  }
  if (spline->Degree() > 1 || spline->NbPoles() > 2) return Handle(Geom2d_Curve)(spline);
  // Lines as lines, that curves in space become lines and circles.
  const gp_Pnt2d a = spline->Pole(1);
  const gp_Pnt2d b = spline->Pole(2);
  return straightPcurve(a, b, spline->FirstParameter(), spline->LastParameter());
}

/// On the surface, without a curve in space.
TopoDS_Edge lifted(const TopoDS_Edge& flat, const Handle(Geom_Surface) & surface,
                   const TopoDS_Vertex& from, const TopoDS_Vertex& to, const Vec2& scale) {
  double first = 0;
  double last = 0;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(flat, first, last);
  const BRep_Builder builder;
  const TopLoc_Location nowhere;
  TopoDS_Edge edge;
  builder.MakeEdge(edge);
  builder.Add(edge, from.Oriented(TopAbs_FORWARD));
  builder.Add(edge, to.Oriented(TopAbs_REVERSED));
  builder.UpdateEdge(edge, unscaled(curve, first, last, scale), surface, nowhere,
                     Precision::Confusion());
  builder.Range(edge, surface, nowhere, first, last);
  builder.Range(edge, first, last);
  return edge;
}

/// A loop's edge in the plane, in the direction of the loop.
struct LoopEdge {
  Handle(Geom_Curve) curve;
  gp_Pnt from, to;
  bool reversed = false;
};

std::vector<LoopEdge> loopEdges(const TopoDS_Wire& wire, const TopoDS_Face& face,
                                const Vec2& scale) {
  std::vector<LoopEdge> edges;
  for (BRepTools_WireExplorer explorer(wire, face); explorer.More(); explorer.Next()) {
    const TopoDS_Edge& edge = explorer.Current();
    double first = 0;
    double last = 0;
    const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
    if (curve.IsNull() || !(last - first > 0)) continue;
    LoopEdge here;
    here.curve = scaled(curve, first, last, scale);
    here.reversed = edge.Orientation() == TopAbs_REVERSED;
    here.from = here.curve->Value(here.curve->FirstParameter());
    here.to = here.curve->Value(here.curve->LastParameter());
    if (here.from.Distance(here.to) < Precision::Confusion() && here.curve->IsClosed() &&
        here.curve->Value((here.curve->FirstParameter() + here.curve->LastParameter()) / 2)
                .Distance(here.from) < Precision::Confusion())
      continue;  // no length
    if (here.reversed) std::swap(here.from, here.to);
    edges.push_back(here);
  }
  return edges;
}

Result<TopoDS_Wire> planarLoop(const std::vector<LoopEdge>& edges, double widestGap) {
  std::vector<TopoDS_Vertex> corners;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const gp_Pnt& end = edges[(i + edges.size() - 1) % edges.size()].to;
    const double gap = end.Distance(edges[i].from);
    if (gap > widestGap)
      return fail(ErrorCode::Failed, "a loop of the face is open in its parameters");
    const gp_Pnt middle(0.5 * (end.XYZ() + edges[i].from.XYZ()));
    corners.push_back(makeVertex(middle, std::max(0.51 * gap, Precision::Confusion())));
  }
  TopoDS_Wire wire;
  const BRep_Builder builder;
  builder.MakeWire(wire);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const LoopEdge& e = edges[i];
    TopoDS_Vertex from = corners[i];
    TopoDS_Vertex to = corners[(i + 1) % edges.size()];
    if (e.reversed) std::swap(from, to);
    const TopoDS_Edge edge = plainEdge(e.curve, e.curve->FirstParameter(), e.curve->LastParameter(),
                                       from, to, Precision::Confusion());
    builder.Add(wire, edge.Oriented(e.reversed ? TopAbs_REVERSED : TopAbs_FORWARD));
  }
  wire.Closed(Standard_True);
  return wire;
}

double turnAt(const Vec2& before, const Vec2& here, const Vec2& after) {
  const Vec2 a = here - before;
  const Vec2 b = after - here;
  return std::abs(std::atan2(a[0] * b[1] - a[1] * b[0], a.dot(b)));
}

/// Whether a curve through three points would leave the longer segment by more than the chord as
/// the shorter is turned.
bool bulging(const Vec2& before, const Vec2& here, const Vec2& after, double chord) {
  const double a = (here - before).norm();
  const double b = (after - here).norm();
  return a > kCornerSize * chord / 2 && std::max(a, b) > kUneven * std::min(a, b) &&
         turnAt(before, here, after) * std::max(a, b) / 8 > chord;
}

/// Smooth parts of a line: each goes from a corner to the next. Where a line turns within some
/// chords, or would bulge, that is a corner, too.
std::vector<std::vector<Vec2>> smoothParts(const Contour& line, double chord) {
  std::vector<Vec2> points = line.points;
  if (line.closed) points.push_back(points.front());
  std::vector<std::vector<Vec2>> parts(1);
  parts.back().push_back(points.front());
  for (std::size_t i = 1; i < points.size(); ++i) {
    const bool last = i + 1 == points.size();
    const double fromCorner = (points[i] - parts.back().front()).norm();
    const double before = (points[i] - points[i - 1]).norm();
    const double after = last ? 0 : (points[i + 1] - points[i]).norm();
    const double turn = last ? 0 : turnAt(points[i - 1], points[i], points[i + 1]);
    const double shorter = std::min(before, after);
    const bool bulges = !last && bulging(parts.back().back(), points[i], points[i + 1], chord);
    const bool corner =
        turn > kCorner || (turn > kSharpTurn && shorter < kCornerSize * chord) || bulges;
    // What follows a corner within its size belongs to it, and points are not noise's length apart.
    if (!last && fromCorner < kCornerSize * chord) continue;
    const double gap = (points[i] - parts.back().back()).norm();
    if (!last && gap < (corner ? kSamePoint : kCornerSize / 2) * chord) continue;
    // The end is kept, in place of a point too near to it for a curve through both.
    if (last && parts.back().size() > 1 && gap < kCornerSize * chord / 2) parts.back().pop_back();
    parts.back().push_back(points[i]);
    if (corner && !last) parts.push_back({points[i]});
  }
  if (parts.back().size() < 2 ||
      (parts.back().size() == 2 &&
       (parts.back()[1] - parts.back()[0]).norm() < Precision::Confusion()))
    parts.pop_back();
  // A closed line is cut in two at least: edges end in different points.
  if (line.closed && parts.size() == 1 && parts.front().size() > 3) {
    const std::vector<Vec2> whole = parts.front();
    const auto middle = static_cast<std::ptrdiff_t>(whole.size() / 2);
    parts = {{whole.begin(), whole.begin() + middle + 1}, {whole.begin() + middle, whole.end()}};
  }
  return parts;
}

Handle(Geom_Curve) curveThrough(const std::vector<Vec2>& points) {
  const int count = static_cast<int>(points.size());
  if (count == 2) {
    const gp_Pnt a = planePoint(points[0]);
    const gp_Pnt b = planePoint(points[1]);
    return new Geom_TrimmedCurve(new Geom_Line(a, gp_Dir(gp_Vec(a, b))), 0, a.Distance(b));
  }
  const Handle(TColgp_HArray1OfPnt) array = new TColgp_HArray1OfPnt(1, count);
  for (int i = 1; i <= count; ++i)
    array->SetValue(i, planePoint(points[static_cast<std::size_t>(i - 1)]));
  GeomAPI_Interpolate interpolation(array, Standard_False, Precision::Confusion());
  interpolation.Perform();
  return Handle(Geom_Curve)(interpolation.Curve());
}

}  // namespace

Result<TopoDS_Face> ParameterPlane::domainOf(const TopoDS_Face& original) const {
  const TopoDS_Face face = TopoDS::Face(original.Oriented(TopAbs_FORWARD));
  double size = 0;
  std::vector<std::vector<LoopEdge>> loops;
  for (TopExp_Explorer wires(face, TopAbs_WIRE); wires.More(); wires.Next()) {
    const TopoDS_Wire wire = TopoDS::Wire(wires.Current());
    std::vector<LoopEdge> edges = loopEdges(wire, face, scale_);
    if (edges.empty()) continue;
    for (const LoopEdge& e : edges) {
      const gp_Pnt middle =
          e.curve->Value((e.curve->FirstParameter() + e.curve->LastParameter()) / 2);
      for (const gp_Pnt& p : {e.from, middle})
        size = std::max(size, p.Distance(edges.front().from));
    }
    loops.push_back(std::move(edges));
  }
  if (loops.empty()) return fail(ErrorCode::Failed, "the face has no loops in its parameters");
  TopoDS_Face domain;
  const BRep_Builder builder;
  builder.MakeFace(domain, new Geom_Plane(gp_Pln()), Precision::Confusion());
  for (const std::vector<LoopEdge>& edges : loops) {
    const Result<TopoDS_Wire> wire = planarLoop(edges, kOpen * size);
    if (!wire) return tl::unexpected(wire.error());
    builder.Add(domain, *wire);
  }
  return domain;
}

std::vector<TopoDS_Edge> ParameterPlane::edgesAlong(const std::vector<Contour>& lines,
                                                    double chord) {
  std::vector<TopoDS_Edge> edges;
  for (const Contour& line : lines) {
    if (line.points.size() < 2) continue;
    const std::vector<std::vector<Vec2>> parts = smoothParts(line, chord);
    if (parts.empty()) continue;
    std::vector<TopoDS_Vertex> ends;
    for (const std::vector<Vec2>& part : parts)
      ends.push_back(makeVertex(planePoint(part.front()), Precision::Confusion()));
    ends.push_back(line.closed
                       ? ends.front()
                       : makeVertex(planePoint(parts.back().back()), Precision::Confusion()));
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const Handle(Geom_Curve) curve = curveThrough(parts[k]);
      edges.push_back(plainEdge(curve, curve->FirstParameter(), curve->LastParameter(), ends[k],
                                ends[k + 1], Precision::Confusion()));
    }
  }
  return edges;
}

TopoDS_Edge ParameterPlane::edgeBetween(const Vec2& a, const Vec2& b) const {
  return straightEdge(makeVertex(planePoint(toPlane(a)), Precision::Confusion()),
                      makeVertex(planePoint(toPlane(b)), Precision::Confusion()),
                      Precision::Confusion());
}

Result<std::vector<TopoDS_Face>> ParameterPlane::split(const TopoDS_Face& domain,
                                                       const std::vector<TopoDS_Edge>& edges) {
  std::vector<TopoDS_Face> faces;
  if (edges.empty()) {
    faces.push_back(domain);
    return faces;
  }
  TopTools_ListOfShape arguments;
  TopTools_ListOfShape tools;
  arguments.Append(domain);
  for (const TopoDS_Edge& edge : edges) tools.Append(edge);
  BRepAlgoAPI_Splitter splitter;
  splitter.SetArguments(arguments);
  splitter.SetTools(tools);
  splitter.SetNonDestructive(Standard_True);
  splitter.Build();
  if (!splitter.IsDone() || splitter.HasErrors())
    return fail(ErrorCode::Failed, "the domain of the face could not be cut");
  for (TopExp_Explorer it(splitter.Shape(), TopAbs_FACE); it.More(); it.Next())
    faces.push_back(TopoDS::Face(it.Current()));
  return faces;
}

Result<TopoDS_Face> ParameterPlane::onSurface(const TopoDS_Face& domain,
                                              const Handle(Geom_Surface) & surface,
                                              double tolerance) const {
  const BRep_Builder builder;
  TopTools_IndexedMapOfShape flatVertices;
  TopExp::MapShapes(domain, TopAbs_VERTEX, flatVertices);
  std::vector<TopoDS_Vertex> vertices(static_cast<std::size_t>(flatVertices.Extent()) + 1);
  const auto pointAt = [&](const gp_Pnt& flat) {
    const Vec2 uv = fromPlane({flat.X(), flat.Y()});
    return surface->Value(uv[0], uv[1]);
  };
  TopTools_IndexedMapOfShape flatEdges;
  TopExp::MapShapes(domain, TopAbs_EDGE, flatEdges);
  // An edge that is a point in space has one vertex.
  std::vector<bool> isPoint(static_cast<std::size_t>(flatEdges.Extent()) + 1, false);
  for (int e = 1; e <= flatEdges.Extent(); ++e) {
    double first = 0;
    double last = 0;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(TopoDS::Edge(flatEdges(e)), first, last);
    if (curve.IsNull()) return fail(ErrorCode::Failed, "a cut edge has no curve");
    const gp_Pnt start = pointAt(curve->Value(first));
    double length = 0;
    for (int i = 1; i <= kLengthSamples; ++i)
      length = std::max(
          length,
          start.Distance(pointAt(curve->Value(first + (last - first) * i / kLengthSamples))));
    isPoint[static_cast<std::size_t>(e)] = length < Precision::Confusion();
  }
  for (int e = 1; e <= flatEdges.Extent(); ++e) {
    if (!isPoint[static_cast<std::size_t>(e)]) continue;
    const TopoDS_Edge& edge = TopoDS::Edge(flatEdges(e));
    const auto from = static_cast<std::size_t>(flatVertices.FindIndex(TopExp::FirstVertex(edge)));
    const auto to = static_cast<std::size_t>(flatVertices.FindIndex(TopExp::LastVertex(edge)));
    TopoDS_Vertex vertex = !vertices[from].IsNull() ? vertices[from] : vertices[to];
    if (vertex.IsNull())
      vertex =
          makeVertex(pointAt(BRep_Tool::Pnt(TopExp::FirstVertex(edge))), Precision::Confusion());
    vertices[from] = vertices[to] = vertex;
  }
  for (int v = 1; v <= flatVertices.Extent(); ++v) {
    TopoDS_Vertex& vertex = vertices[static_cast<std::size_t>(v)];
    if (vertex.IsNull())
      vertex = makeVertex(pointAt(BRep_Tool::Pnt(TopoDS::Vertex(flatVertices(v)))),
                          Precision::Confusion());
  }
  std::vector<TopoDS_Edge> edges(static_cast<std::size_t>(flatEdges.Extent()) + 1);
  for (int e = 1; e <= flatEdges.Extent(); ++e) {
    const TopoDS_Edge flat = TopoDS::Edge(flatEdges(e).Oriented(TopAbs_FORWARD));
    const auto vertexOf = [&](const TopoDS_Vertex& v) {
      return vertices[static_cast<std::size_t>(flatVertices.FindIndex(v))];
    };
    TopoDS_Edge& edge = edges[static_cast<std::size_t>(e)];
    edge = lifted(flat, surface, vertexOf(TopExp::FirstVertex(flat)),
                  vertexOf(TopExp::LastVertex(flat)), scale_);
    if (isPoint[static_cast<std::size_t>(e)]) builder.Degenerated(edge, Standard_True);
  }
  TopoDS_Face face;
  builder.MakeFace(face, surface, Precision::Confusion());
  for (TopoDS_Iterator wires(domain.Oriented(TopAbs_FORWARD)); wires.More(); wires.Next()) {
    if (wires.Value().ShapeType() != TopAbs_WIRE) continue;
    TopoDS_Wire wire;
    builder.MakeWire(wire);
    for (TopoDS_Iterator it(wires.Value()); it.More(); it.Next()) {
      const TopoDS_Edge& edge = edges[static_cast<std::size_t>(flatEdges.FindIndex(it.Value()))];
      builder.Add(wire, edge.Oriented(it.Value().Orientation()));
    }
    wire.Closed(Standard_True);
    builder.Add(face, wire.Oriented(wires.Value().Orientation()));
  }
  for (int e = 1; e <= flatEdges.Extent(); ++e) {
    const auto n = static_cast<std::size_t>(e);
    if (isPoint[n] || BRepLib::BuildCurve3d(edges[n], tolerance, GeomAbs_C1)) continue;
    return fail(ErrorCode::Failed, "an edge of the offset has no curve in space");
  }
  settleTolerances({face});
  return face;
}

std::vector<TopoDS_Edge> ParameterPlane::onSurface(const std::vector<TopoDS_Edge>& flatEdges,
                                                   const Handle(Geom_Surface) & surface,
                                                   double tolerance) const {
  TopTools_DataMapOfShapeShape vertices;
  const auto vertexOf = [&](const TopoDS_Vertex& flat) {
    if (!vertices.IsBound(flat)) {
      const gp_Pnt p = BRep_Tool::Pnt(flat);
      const Vec2 uv = fromPlane({p.X(), p.Y()});
      vertices.Bind(flat, makeVertex(surface->Value(uv[0], uv[1]), tolerance));
    }
    return TopoDS::Vertex(vertices.Find(flat));
  };
  std::vector<TopoDS_Edge> edges;
  for (const TopoDS_Edge& any : flatEdges) {
    const TopoDS_Edge flat = TopoDS::Edge(any.Oriented(TopAbs_FORWARD));
    const TopoDS_Edge edge = lifted(flat, surface, vertexOf(TopExp::FirstVertex(flat)),
                                    vertexOf(TopExp::LastVertex(flat)), scale_);
    if (BRepLib::BuildCurve3d(edge, tolerance, GeomAbs_C1)) edges.push_back(edge);
  }
  return edges;
}

}  // namespace phront::cad
