// Every curve of an edge, in space and in its faces, has the same parameter; so all are shifted by
// the same amount: circles by turning them, lines by moving their origin, B-splines by their knots.
#include "exchange/arc_ranges.h"

#include <BRep_Curve3D.hxx>
#include <BRep_CurveOnClosedSurface.hxx>
#include <BRep_CurveOnSurface.hxx>
#include <BRep_ListIteratorOfListOfCurveRepresentation.hxx>
#include <BRep_TEdge.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_Circle.hxx>
#include <Geom2d_Line.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <Geom_Circle.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <cmath>
#include <utility>
#include <vector>

namespace phront::cad {
namespace {

constexpr double kTurn = 2 * M_PI;

bool crossesZero(double first, double last) {
  const double slack = Precision::PConfusion();
  if (last - first > kTurn - slack) return false;  // a whole turn: starts at its vertex anyway
  const double zero = kTurn * std::ceil((first + slack) / kTurn);
  return zero < last - slack;
}

/// The same curve, its parameter counted from `shift`; null where that is not known.
Handle(Geom2d_Curve) shifted(const Handle(Geom2d_Curve) & curve, double shift) {
  if (const auto trimmed = Handle(Geom2d_TrimmedCurve)::DownCast(curve); !trimmed.IsNull()) {
    const Handle(Geom2d_Curve) basis = shifted(trimmed->BasisCurve(), shift);
    if (basis.IsNull()) return {};
    return new Geom2d_TrimmedCurve(basis, trimmed->FirstParameter() - shift,
                                   trimmed->LastParameter() - shift);
  }
  if (const auto line = Handle(Geom2d_Line)::DownCast(curve); !line.IsNull())
    return new Geom2d_Line(line->Value(shift), line->Direction());
  if (const auto spline = Handle(Geom2d_BSplineCurve)::DownCast(curve); !spline.IsNull()) {
    const Handle(Geom2d_BSplineCurve) result =
        Handle(Geom2d_BSplineCurve)::DownCast(spline->Copy());
    TColStd_Array1OfReal knots(1, result->NbKnots());
    result->Knots(knots);
    for (double& knot : knots) knot -= shift;
    result->SetKnots(knots);
    return Handle(Geom2d_Curve)(result);
  }
  if (const auto circle = Handle(Geom2d_Circle)::DownCast(curve); !circle.IsNull()) {
    const Handle(Geom2d_Circle) result = Handle(Geom2d_Circle)::DownCast(circle->Copy());
    const gp_Ax22d axes = circle->Position();
    const bool direct = axes.XDirection().Crossed(axes.YDirection()) > 0;
    result->Rotate(circle->Location(), direct ? shift : -shift);
    return Handle(Geom2d_Curve)(result);
  }
  return {};
}

/// Where the curves of an edge are kept, and what they become.
struct Shift {
  std::vector<std::pair<Handle(BRep_CurveOnSurface), Handle(Geom2d_Curve)>> onSurface;
  std::vector<std::pair<Handle(BRep_CurveOnClosedSurface), Handle(Geom2d_Curve)>> onSeam;
};

void keepWithinOneTurn(const TopoDS_Edge& edge) {
  double first = 0;
  double last = 0;
  TopLoc_Location location;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, location, first, last);
  const auto circle = Handle(Geom_Circle)::DownCast(curve);
  if (circle.IsNull() || !crossesZero(first, last)) return;
  const double shift = (first + last) / 2 - M_PI;

  Shift follow;
  const Handle(BRep_TEdge) data = Handle(BRep_TEdge)::DownCast(edge.TShape());
  for (BRep_ListIteratorOfListOfCurveRepresentation it(data->Curves()); it.More(); it.Next()) {
    const Handle(BRep_CurveOnSurface) on = Handle(BRep_CurveOnSurface)::DownCast(it.Value());
    if (on.IsNull()) continue;
    const Handle(Geom2d_Curve) moved = shifted(on->PCurve(), shift);
    if (moved.IsNull()) return;
    follow.onSurface.emplace_back(on, moved);
    const auto seam = Handle(BRep_CurveOnClosedSurface)::DownCast(on);
    if (seam.IsNull()) continue;
    const Handle(Geom2d_Curve) other = shifted(seam->PCurve2(), shift);
    if (other.IsNull()) return;
    follow.onSeam.emplace_back(seam, other);
  }
  for (const auto& [on, moved] : follow.onSurface) on->PCurve(moved);
  for (const auto& [seam, moved] : follow.onSeam) seam->PCurve2(moved);
  const auto turned = Handle(Geom_Circle)::DownCast(circle->Copy());
  turned->Rotate(circle->Axis(), shift);
  for (BRep_ListIteratorOfListOfCurveRepresentation it(data->Curves()); it.More(); it.Next()) {
    if (it.Value()->IsCurve3D()) it.Value()->Curve3D(turned);
    if (const auto range = Handle(BRep_GCurve)::DownCast(it.Value()); !range.IsNull())
      range->SetRange(range->First() - shift, range->Last() - shift);
  }
}

}  // namespace

void keepArcsWithinOneTurn(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape edges;
  TopExp::MapShapes(shape, TopAbs_EDGE, edges);
  for (int k = 1; k <= edges.Extent(); ++k) keepWithinOneTurn(TopoDS::Edge(edges(k)));
}

}  // namespace phront::cad
