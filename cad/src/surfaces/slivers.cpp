#include "surfaces/slivers.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepGProp.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <GProp_GProps.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Wire.hxx>
#include <cmath>

namespace phront::cad {
namespace {

constexpr int kPoints = 40;  // of an edge

/// Of loops in a plane z = const.
double widthOf(const TopoDS_Shape& loops) {
  double area = 0;
  double length = 0;
  for (TopExp_Explorer it(loops, TopAbs_EDGE); it.More(); it.Next()) {
    const TopAbs_Orientation way = it.Current().Orientation();
    if (way != TopAbs_FORWARD && way != TopAbs_REVERSED) continue;  // not of a loop
    const BRepAdaptor_Curve curve(TopoDS::Edge(it.Current()));
    const double first = curve.FirstParameter();
    const double step = (curve.LastParameter() - first) / kPoints;
    gp_Pnt from = curve.Value(first);
    for (int i = 1; i <= kPoints; ++i) {
      const gp_Pnt to = curve.Value(first + i * step);
      const double under = (from.X() * to.Y() - from.Y() * to.X()) / 2;
      area += way == TopAbs_FORWARD ? under : -under;
      length += from.Distance(to);
      from = to;
    }
  }
  return length > 0 ? 2 * std::abs(area) / length : 0;
}

}  // namespace

double meanWidth(const TopoDS_Face& face) {
  GProp_GProps area;
  GProp_GProps length;
  BRepGProp::SurfaceProperties(face, area);
  BRepGProp::LinearProperties(face, length);
  return length.Mass() > 0 ? 2 * std::abs(area.Mass()) / length.Mass() : 0;
}

TopoDS_Face withoutSlits(const TopoDS_Face& face, double width) {
  const TopoDS_Wire outer = BRepTools::OuterWire(face);
  TopoDS_Face whole = TopoDS::Face(face.EmptyCopied());
  const BRep_Builder builder;
  for (TopExp_Explorer it(face, TopAbs_WIRE); it.More(); it.Next()) {
    if (it.Current().IsSame(outer) || widthOf(it.Current()) >= width)
      builder.Add(whole, it.Current());
  }
  return whole;
}

}  // namespace phront::cad
