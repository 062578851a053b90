// Intersecting, meshing and healing take a tolerance at its word: one too small makes a shape
// invalid, one too large swallows what is near. Both are measured at samples along the edges.
#include "exchange/tolerances.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRep_Builder.hxx>
#include <BRep_TEdge.hxx>
#include <BRep_TVertex.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <utility>

namespace phront::cad {
namespace {

void setTolerance(const TopoDS_Shape& part, double tolerance) {
  if (part.ShapeType() == TopAbs_EDGE)
    Handle(BRep_TEdge)::DownCast(part.TShape())->Tolerance(tolerance);
  else
    Handle(BRep_TVertex)::DownCast(part.TShape())->Tolerance(tolerance);
}

double toleranceOf(const TopoDS_Shape& part) {
  return part.ShapeType() == TopAbs_EDGE ? BRep_Tool::Tolerance(TopoDS::Edge(part))
                                         : BRep_Tool::Tolerance(TopoDS::Vertex(part));
}

}  // namespace

double raiseTolerance(const TopoDS_Edge& edge, const TopoDS_Face& face) {
  constexpr int kSamples = 23;
  double first = 0;
  double last = 0;
  TopLoc_Location location;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, location, first, last);
  double first2d = 0;
  double last2d = 0;
  const Handle(Geom2d_Curve) pcurve = BRep_Tool::CurveOnSurface(edge, face, first2d, last2d);
  if (curve.IsNull() || pcurve.IsNull()) return 0;
  const BRepAdaptor_Surface surface(face, Standard_False);
  double worst = 0;
  for (int i = 0; i < kSamples; ++i) {
    const double s = static_cast<double>(i) / (kSamples - 1);
    const gp_Pnt2d uv = pcurve->Value(first2d + s * (last2d - first2d));
    gp_Pnt onCurve = curve->Value(first + s * (last - first));
    onCurve.Transform(location.Transformation());
    worst = std::max(worst, onCurve.Distance(surface.Value(uv.X(), uv.Y())));
  }
  // Between the samples the distance may be a little larger.
  const double tolerance = std::max(1.1 * worst, Precision::Confusion());
  const BRep_Builder builder;
  builder.UpdateEdge(edge, tolerance);
  for (TopoDS_Iterator it(edge); it.More(); it.Next()) {
    builder.UpdateVertex(TopoDS::Vertex(it.Value()), tolerance);
  }
  return worst;
}

void settleTolerances(const std::vector<TopoDS_Face>& faces) {
  const BRep_Builder builder;
  for (const TopoDS_Face& face : faces) {
    const BRepAdaptor_Surface surface(face, Standard_False);
    for (TopExp_Explorer uses(face, TopAbs_EDGE); uses.More(); uses.Next()) {
      const TopoDS_Edge& edge = TopoDS::Edge(uses.Current());
      if (BRep_Tool::Degenerated(edge)) continue;
      raiseTolerance(edge, face);
      TopoDS_Vertex ends[2];
      TopExp::Vertices(edge, ends[0], ends[1]);
      double range3d[2];
      double range2d[2];
      const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, range3d[0], range3d[1]);
      const Handle(Geom2d_Curve) pcurve =
          BRep_Tool::CurveOnSurface(edge, face, range2d[0], range2d[1]);
      for (int k = 0; k < 2; ++k) {
        if (ends[k].IsNull()) continue;
        const gp_Pnt vertex = BRep_Tool::Pnt(ends[k]);
        double gap = curve.IsNull() ? 0 : vertex.Distance(curve->Value(range3d[k]));
        if (!pcurve.IsNull()) {
          const gp_Pnt2d uv = pcurve->Value(range2d[k]);
          gap = std::max(gap, vertex.Distance(surface.Value(uv.X(), uv.Y())));
        }
        builder.UpdateVertex(ends[k], std::max(1.01 * gap, Precision::Confusion()));
      }
    }
  }
}

void lowerTolerances(const TopoDS_Shape& shape, double limit) {
  TopTools_IndexedMapOfShape parts;
  TopExp::MapShapes(shape, TopAbs_EDGE, parts);
  TopExp::MapShapes(shape, TopAbs_VERTEX, parts);
  std::vector<std::pair<TopoDS_Shape, double>> before;
  for (int i = 1; i <= parts.Extent(); ++i) {
    const double tolerance = toleranceOf(parts(i));
    if (tolerance > limit) before.emplace_back(parts(i), tolerance);
  }
  if (before.empty()) return;
  const bool valid = BRepCheck_Analyzer(shape).IsValid();
  for (const auto& [part, tolerance] : before) setTolerance(part, Precision::Confusion());
  std::vector<TopoDS_Face> faces;
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(shape, TopAbs_FACE, map);
  for (int i = 1; i <= map.Extent(); ++i) faces.push_back(TopoDS::Face(map(i)));
  settleTolerances(faces);
  // A vertex covers its edges, also those that were left as they are.
  const BRep_Builder builder;
  for (int i = 1; i <= parts.Extent(); ++i)
    for (TopoDS_Iterator end(parts(i)); end.More(); end.Next())
      builder.UpdateVertex(TopoDS::Vertex(end.Value()), toleranceOf(parts(i)));
  if (!valid || BRepCheck_Analyzer(shape).IsValid()) return;
  for (const auto& [part, tolerance] : before) setTolerance(part, tolerance);
}

}  // namespace phront::cad
