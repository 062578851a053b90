#include "move/reaching_face.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <Geom_Plane.hxx>
#include <Precision.hxx>
#include <ShapeAnalysis_Surface.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Ax3.hxx>
#include <gp_Cone.hxx>
#include <gp_Pln.hxx>
#include <limits>
#include <numbers>

#include "patches/patch_tools.h"

namespace phront::cad {
namespace {

constexpr int kEdgeSamples = 24;
constexpr double kWhole = 1e-6;       // rad: how near to a whole turn is one
constexpr double kApexShare = 0.999;  // of the way to it: the apex itself is no edge

/// A range that grows; parameters of a closed direction are taken near its first.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void add(double x, double period, double middle) {
    if (period > 0) x -= period * std::round((x - middle) / period);
    low = std::min(low, x);
    high = std::max(high, x);
  }
  /// A whole turn starts at `seam`, as the face does.
  void close(double period, double seam) {
    low = seam;
    high = seam + period;
  }
  void clamp(double least, double most) {
    low = std::clamp(low, least, most);
    high = std::clamp(high, least, most);
  }
};

/// Along the first straight edge, so that the rectangle does not stick out beside it.
Handle(Geom_Surface) aligned(const gp_Pln& plane, const TopoDS_Face& face) {
  gp_Ax3 axes = plane.Position();
  for (const TopoDS_Edge& edge : edgesOf(face)) {
    const BRepAdaptor_Curve curve(edge);
    if (curve.GetType() != GeomAbs_Line) continue;
    axes = gp_Ax3(axes.Location(), axes.Direction(), curve.Line().Direction());
    break;
  }
  return new Geom_Plane(axes);
}

void keepOffApex(const gp_Cone& cone, double middle, Range& v) {
  const double apex = -cone.RefRadius() / std::sin(cone.SemiAngle());
  const double last = middle + kApexShare * (apex - middle);
  if (middle < apex)
    v.high = std::min(v.high, last);
  else
    v.low = std::max(v.low, last);
}

}  // namespace

std::vector<gp_Pnt> outlineOf(const TopoDS_Face& face) {
  std::vector<gp_Pnt> points;
  for (const TopoDS_Edge& edge : edgesOf(face)) {
    if (BRep_Tool::Degenerated(edge)) continue;
    const BRepAdaptor_Curve curve(edge);
    for (int i = 0; i <= kEdgeSamples; ++i) {
      const double share = static_cast<double>(i) / kEdgeSamples;
      points.push_back(
          curve.Value(std::lerp(curve.FirstParameter(), curve.LastParameter(), share)));
    }
  }
  return points;
}

TopoDS_Face reachingFace(const Handle(Geom_Surface) & surface, const TopoDS_Face& face,
                         const std::vector<gp_Pnt>& outline, const std::vector<gp_Pnt>& beyond) {
  const GeomAdaptor_Surface kind(surface);
  const GeomAbs_SurfaceType type = kind.GetType();
  if (type > GeomAbs_Torus) return {};
  const Handle(Geom_Surface) on = type == GeomAbs_Plane ? aligned(kind.Plane(), face) : surface;
  const double uPeriod = on->IsUPeriodic() ? on->UPeriod() : 0;
  const double vPeriod = on->IsVPeriodic() ? on->VPeriod() : 0;
  double uMin = 0;
  double uMax = 0;
  double vMin = 0;
  double vMax = 0;
  BRepTools::UVBounds(face, uMin, uMax, vMin, vMax);
  Range u;
  Range v;
  ShapeAnalysis_Surface analysis(on);
  const auto add = [&](const gp_Pnt& point) {
    const gp_Pnt2d uv = analysis.ValueOfUV(point, Precision::Confusion());
    u.add(uv.X(), uPeriod, 0.5 * (uMin + uMax));
    v.add(uv.Y(), vPeriod, 0.5 * (vMin + vMax));
  };
  for (const gp_Pnt& point : outline) add(point);
  const double middle = 0.5 * (v.low + v.high);
  for (const gp_Pnt& point : beyond) add(point);
  const auto isWhole = [](const Range& range, double least, double most, double period) {
    return period > 0 && std::max(range.high - range.low, most - least) > period - kWhole;
  };
  if (isWhole(u, uMin, uMax, uPeriod)) u.close(uPeriod, uMin);
  if (isWhole(v, vMin, vMax, vPeriod)) v.close(vPeriod, vMin);
  if (type == GeomAbs_Cone) keepOffApex(kind.Cone(), middle, v);
  if (type == GeomAbs_Sphere) v.clamp(-0.5 * std::numbers::pi, 0.5 * std::numbers::pi);
  const BRepBuilderAPI_MakeFace made(on, u.low, u.high, v.low, v.high, Precision::Confusion());
  return made.IsDone() ? made.Face() : TopoDS_Face();
}

}  // namespace phront::cad
