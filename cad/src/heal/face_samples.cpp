#include "heal/face_samples.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepTools.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Precision.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TopoDS.hxx>
#include <algorithm>

#include "patches/patch_tools.h"

namespace phront::cad {
namespace {

// Samples per knot span and per direction; a B-spline may leave its primitive inside one span.
constexpr int kPerSpan = 4;
constexpr int kMostPerDirection = 24;
constexpr int kPerEdge = 9;

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

}  // namespace

std::vector<SurfacePoint> samplesOf(const TopoDS_Face& oriented) {
  const TopoDS_Face face = TopoDS::Face(oriented.Oriented(TopAbs_FORWARD));
  const BRepAdaptor_Surface surface(face, Standard_False);
  std::vector<SurfacePoint> points;
  const auto add = [&](const gp_Pnt2d& uv) {
    if (const std::optional<gp_Vec> n = outwardNormal(face, uv)) {
      const gp_Pnt p = surface.Value(uv.X(), uv.Y());
      points.push_back({{p.X(), p.Y(), p.Z()}, {n->X(), n->Y(), n->Z()}});
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
    const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
    for (int i = 0; i < kPerEdge && !curve.IsNull(); ++i) {
      add(curve->Value(first + (last - first) * i / (kPerEdge - 1)));
    }
  }
  return points;
}

}  // namespace phront::cad
