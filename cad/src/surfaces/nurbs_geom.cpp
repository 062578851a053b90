#include "surfaces/nurbs_geom.h"

#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_Array2OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <algorithm>
#include <cmath>

namespace phront::cad {
namespace {

constexpr double kSameParameter = 1e-9;  // of the domain

Vec3 vectorOf(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }
gp_Pnt pointOf(const Vec3& p) { return {p[0], p[1], p[2]}; }

/// `part` with ends on those of the domain when they are hardly apart.
Interval snapped(Interval part, double first, double last, bool periodic) {
  if (periodic) {
    // A whole turn may be a little longer than the period.
    part.high = std::min(part.high, part.low + (last - first));
    return part;
  }
  const double near = kSameParameter * (last - first);
  if (part.low < first + near) part.low = first;
  if (part.high > last - near) part.high = last;
  return part;
}

std::vector<double> values(const TColStd_Array1OfReal& flat) { return {flat.begin(), flat.end()}; }

/// OpenCASCADE's knots with multiplicities.
struct KnotArrays {
  TColStd_Array1OfReal knots;
  TColStd_Array1OfInteger multiplicities;
  explicit KnotArrays(const Knots& from) : KnotArrays(from, from.distinct()) {}

 private:
  KnotArrays(const Knots& from, const std::vector<double>& distinct)
      : knots(1, static_cast<int>(distinct.size())),
        multiplicities(1, static_cast<int>(distinct.size())) {
    int k = 0;
    for (const double knot : distinct) {
      const auto range = std::equal_range(from.flat.begin(), from.flat.end(), knot);
      ++k;
      knots(k) = knot;
      multiplicities(k) = static_cast<int>(range.second - range.first);
    }
  }
};

}  // namespace

NurbsCurve nurbsOf(const Geom_BSplineCurve& curve, const Interval& part) {
  const Handle(Geom_BSplineCurve) piece = Handle(Geom_BSplineCurve)::DownCast(curve.Copy());
  const Interval ends =
      snapped(part, curve.FirstParameter(), curve.LastParameter(), curve.IsPeriodic());
  piece->Segment(ends.low, ends.high);
  NurbsCurve result;
  result.knots = {piece->Degree(), values(piece->KnotSequence())};
  for (int i = 1; i <= piece->NbPoles(); ++i) {
    result.poles.push_back(vectorOf(piece->Pole(i)));
    if (piece->IsRational()) result.weights.push_back(piece->Weight(i));
  }
  return result;
}

NurbsSurface nurbsOf(const Geom_BSplineSurface& surface, const ParameterBox& part) {
  const Handle(Geom_BSplineSurface) piece = Handle(Geom_BSplineSurface)::DownCast(surface.Copy());
  double u0 = 0;
  double u1 = 0;
  double v0 = 0;
  double v1 = 0;
  surface.Bounds(u0, u1, v0, v1);
  const Interval u = snapped(part.u, u0, u1, surface.IsUPeriodic());
  const Interval v = snapped(part.v, v0, v1, surface.IsVPeriodic());
  piece->Segment(u.low, u.high, v.low, v.high);
  NurbsSurface result;
  result.u = {piece->UDegree(), values(piece->UKnotSequence())};
  result.v = {piece->VDegree(), values(piece->VKnotSequence())};
  const bool rational = piece->IsURational() || piece->IsVRational();
  for (int j = 1; j <= piece->NbVPoles(); ++j) {
    for (int i = 1; i <= piece->NbUPoles(); ++i) {
      result.poles.push_back(vectorOf(piece->Pole(i, j)));
      if (rational) result.weights.push_back(piece->Weight(i, j));
    }
  }
  return result;
}

Handle(Geom_BSplineCurve) geomOf(const NurbsCurve& curve) {
  const KnotArrays knots(curve.knots);
  const int count = static_cast<int>(curve.poles.size());
  TColgp_Array1OfPnt poles(1, count);
  TColStd_Array1OfReal weights(1, count);
  for (int i = 1; i <= count; ++i) {
    const auto n = static_cast<std::size_t>(i - 1);
    poles(i) = pointOf(curve.poles[n]);
    weights(i) = curve.weights.empty() ? 1 : curve.weights[n];
  }
  if (curve.weights.empty())
    return new Geom_BSplineCurve(poles, knots.knots, knots.multiplicities, curve.knots.degree);
  return new Geom_BSplineCurve(poles, weights, knots.knots, knots.multiplicities,
                               curve.knots.degree);
}

Handle(Geom_BSplineSurface) geomOf(const NurbsSurface& surface) {
  const KnotArrays u(surface.u);
  const KnotArrays v(surface.v);
  const int rows = static_cast<int>(surface.u.poleCount());
  const int columns = static_cast<int>(surface.v.poleCount());
  TColgp_Array2OfPnt poles(1, rows, 1, columns);
  TColStd_Array2OfReal weights(1, rows, 1, columns);
  for (int j = 1; j <= columns; ++j) {
    for (int i = 1; i <= rows; ++i) {
      const auto n = static_cast<std::size_t>((i - 1) + (j - 1) * rows);
      poles(i, j) = pointOf(surface.poles[n]);
      weights(i, j) = surface.weights.empty() ? 1 : surface.weights[n];
    }
  }
  if (surface.weights.empty())
    return new Geom_BSplineSurface(poles, u.knots, v.knots, u.multiplicities, v.multiplicities,
                                   surface.u.degree, surface.v.degree);
  return new Geom_BSplineSurface(poles, weights, u.knots, v.knots, u.multiplicities,
                                 v.multiplicities, surface.u.degree, surface.v.degree);
}

}  // namespace phront::cad
