#include "heal/line_or_circle.h"

#include <BRepAdaptor_Curve.hxx>
#include <Geom_Circle.hxx>
#include <Geom_Line.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Ax2.hxx>
#include <gp_Circ.hxx>
#include <gp_Lin.hxx>
#include <numbers>
#include <vector>

namespace phront::cad {
namespace {

constexpr int kPoints = 33;           // odd: one in the middle
constexpr double kLeastChord = 10;    // in tolerances
constexpr double kCollinear = 1e-24;  // mm^4: square of twice the triangle's area

std::vector<gp_Pnt> pointsOf(const BRepAdaptor_Curve& curve) {
  std::vector<gp_Pnt> points;
  for (int i = 0; i < kPoints; ++i)
    points.push_back(curve.Value(std::lerp(curve.FirstParameter(), curve.LastParameter(),
                                           static_cast<double>(i) / (kPoints - 1))));
  return points;
}

CurveFit lineThrough(const std::vector<gp_Pnt>& points) {
  const gp_Pnt& a = points.front();
  const gp_Pnt& b = points.back();
  const Handle(Geom_Line) line = new Geom_Line(a, gp_Dir(gp_Vec(a, b)));
  CurveFit fit{Handle(Geom_Curve)(line), a.Distance(b)};
  for (const gp_Pnt& p : points)
    fit.deviation = std::max<double>(fit.deviation, line->Lin().Distance(p));
  return fit;
}

/// From the first point over the middle one, which it keeps, to the last.
std::optional<CurveFit> circleThrough(const std::vector<gp_Pnt>& points) {
  const gp_Pnt& a = points.front();
  const gp_Pnt& b = points.back();
  const gp_Pnt& middle = points[points.size() / 2];
  const gp_Vec p(middle, a);
  const gp_Vec q(middle, b);
  const gp_Vec n = p.Crossed(q);
  if (n.SquareMagnitude() < kCollinear) return std::nullopt;
  const gp_Vec arm =
      (q * p.SquareMagnitude() - p * q.SquareMagnitude()).Crossed(n) * (0.5 / n.SquareMagnitude());
  const gp_Pnt centre = middle.Translated(arm);
  const gp_Vec axis = gp_Vec(a, middle).Crossed(gp_Vec(middle, b));
  const gp_Ax2 frame(centre, gp_Dir(axis), gp_Dir(gp_Vec(centre, a)));
  const Handle(Geom_Circle) circle = new Geom_Circle(frame, arm.Magnitude());
  const gp_Vec toB(centre, b);
  CurveFit fit{Handle(Geom_Curve)(circle), std::atan2(toB.Dot(gp_Vec(frame.YDirection())),
                                                      toB.Dot(gp_Vec(frame.XDirection())))};
  if (fit.last <= 0) fit.last += 2 * std::numbers::pi;
  for (const gp_Pnt& s : points)
    fit.deviation = std::max<double>(fit.deviation, circle->Circ().Distance(s));
  return fit;
}

}  // namespace

std::optional<CurveFit> fitLineOrCircle(const TopoDS_Edge& edge, double tolerance) {
  const BRepAdaptor_Curve curve(edge);
  if (curve.GetType() == GeomAbs_Line || curve.GetType() == GeomAbs_Circle) return std::nullopt;
  const std::vector<gp_Pnt> points = pointsOf(curve);
  if (points.front().Distance(points.back()) < kLeastChord * tolerance) return std::nullopt;
  const CurveFit line = lineThrough(points);
  if (line.deviation <= tolerance) return line;
  const std::optional<CurveFit> circle = circleThrough(points);
  return circle && circle->deviation <= tolerance ? circle : std::nullopt;
}

}  // namespace phront::cad
