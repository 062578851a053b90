// Pipe round a circular edge: a torus with the edge's radius R and tube radius |d|. Where R < |d|
// the torus is a spindle: its tube crosses the axis at cos v = -R/|d|, and what lies beyond the
// apex is nearer to the far side of the circle, so it is cut off exactly there. This is every hole
// smaller than the distance.
#include <BRepAdaptor_Curve.hxx>
#include <BRep_Builder.hxx>
#include <Geom_Circle.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Ax3.hxx>
#include <gp_Circ.hxx>

#include "patches/pipe.h"

namespace phront::cad {
namespace {

/// Tube angle of a direction at one point of the circle.
double tubeAngle(const gp_Circ& circle, const EdgeSample& s, const gp_Vec& n) {
  const gp_Vec radial = gp_Vec(circle.Location(), s.point).Normalized();
  return std::atan2(n.Dot(gp_Vec(circle.Axis().Direction())), n.Dot(radial));
}

double wrapped(double angle) {
  while (angle > M_PI) angle -= 2 * M_PI;
  while (angle <= -M_PI) angle += 2 * M_PI;
  return angle;
}

struct TubeRange {
  double low = 0;
  double high = 0;
  bool poleLow = false;  ///< ends at the apex
  bool poleHigh = false;
};

/// Parts of [low, high] on the outer side of the axis.
std::vector<TubeRange> outerRanges(double low, double high, double circleRadius, double tube) {
  if (tube <= circleRadius * (1 - Precision::Angular())) return {{low, high, false, false}};
  const double apex = std::acos(-circleRadius / tube);
  std::vector<TubeRange> ranges;
  for (int k = -2; k <= 2; ++k) {
    const double from = 2 * M_PI * k - apex;
    const double to = 2 * M_PI * k + apex;
    TubeRange r{std::max(low, from), std::min(high, to), false, false};
    if (r.high - r.low < kAngularTolerance) continue;
    r.poleLow = r.low - from < kAngularTolerance;
    r.poleHigh = to - r.high < kAngularTolerance;
    if (r.poleLow) r.low = from;
    if (r.poleHigh) r.high = to;
    ranges.push_back(r);
  }
  return ranges;
}

struct TorusPatch {
  gp_Circ circle;
  Handle(Geom_ToroidalSurface) surface;
  double u0 = 0;  ///< at the first parameter of the edge
  double u1 = 0;
  double t0 = 0;
  double t1 = 0;
};

/// Long side at tube angle v: the given image, or a new circle between the two vertices.
PatchSide longSide(const TorusPatch& p, const TopoDS_Edge& image, double v,
                   const TopoDS_Vertex& from, const TopoDS_Vertex& to) {
  PatchSide side{image, gp_Pnt2d(p.u0, v), gp_Pnt2d(p.u1, v), false, {}};
  if (!image.IsNull()) return side;
  const BRep_Builder builder;
  const gp_Circ iso(p.circle.Position().Translated(gp_Vec(p.circle.Axis().Direction()) *
                                                   (p.surface->MinorRadius() * std::sin(v))),
                    p.circle.Radius() + p.surface->MinorRadius() * std::cos(v));
  builder.MakeEdge(side.edge, new Geom_Circle(iso), Precision::Confusion());
  builder.Add(side.edge, from.Oriented(TopAbs_FORWARD));
  builder.Add(side.edge, to.Oriented(TopAbs_REVERSED));
  builder.Range(side.edge, p.t0, p.t1);
  return side;
}

PatchSide endSide(const TopoDS_Edge& arc, const TopoDS_Vertex& low, double u,
                  const TubeRange& range) {
  const bool upward = TopExp::FirstVertex(arc).IsSame(low);
  const gp_Pnt2d a(u, range.low);
  const gp_Pnt2d b(u, range.high);
  return {arc, upward ? a : b, upward ? b : a, false, {}};
}

}  // namespace

std::optional<std::vector<TopoDS_Face>> circlePipe(const PipeFrame& frame, ArcPool& arcs,
                                                   PointPool& apices) {
  const EdgeInfo& info = *frame.info;
  const BRepAdaptor_Curve curve(info.edge);
  if (curve.GetType() != GeomAbs_Circle) return std::nullopt;
  if (frame.first1.IsNull() || frame.first2.IsNull() || frame.last1.IsNull() ||
      frame.last2.IsNull()) {
    return std::nullopt;
  }
  TorusPatch p;
  p.circle = curve.Circle();
  const EdgeSample& s = info.samples[info.samples.size() / 2];
  const double angle1 = tubeAngle(p.circle, s, s.n1);
  const double angle2 = tubeAngle(p.circle, s, s.n2);
  const double slack = frame.tolerance / frame.radius;
  for (const EdgeSample& other : info.samples) {
    if (std::abs(wrapped(tubeAngle(p.circle, other, other.n1) - angle1)) > slack ||
        std::abs(wrapped(tubeAngle(p.circle, other, other.n2) - angle2)) > slack) {
      return std::nullopt;
    }
  }
  // Tube angles grow from the radial direction to the axis, which turns about minus the tangent.
  const double turn = -std::atan2(s.n1.Crossed(s.n2).Dot(s.tangent), s.n1.Dot(s.n2));
  const bool upward = turn > 0;
  const double low = upward ? angle1 : angle1 + turn;
  const double high = upward ? angle1 + turn : angle1;

  // The seam in u lies opposite the middle of the edge.
  p.t0 = curve.FirstParameter();
  p.t1 = curve.LastParameter();
  const double shift = M_PI - (p.t0 + p.t1) / 2;
  p.u0 = p.t0 + shift;
  p.u1 = p.t1 + shift;
  gp_Ax3 position(p.circle.Position());
  position.Rotate(p.circle.Axis(), -shift);
  p.surface = new Geom_ToroidalSurface(position, p.circle.Radius(), frame.radius);

  std::vector<TopoDS_Face> faces;
  for (const TubeRange& range : outerRanges(low, high, p.circle.Radius(), frame.radius)) {
    const auto apexAt = [&](double v) {
      const gp_Vec up(p.circle.Axis().Direction());
      return apices.at(p.circle.Location().Translated(up * (frame.radius * std::sin(v))),
                       frame.tolerance);
    };
    const bool lowIsOne = upward;
    TopoDS_Vertex lowFirst = lowIsOne ? frame.first1 : frame.first2;
    TopoDS_Vertex lowLast = lowIsOne ? frame.last1 : frame.last2;
    TopoDS_Vertex highFirst = lowIsOne ? frame.first2 : frame.first1;
    TopoDS_Vertex highLast = lowIsOne ? frame.last2 : frame.last1;
    std::vector<PatchSide> sides(4);
    if (range.poleLow) {
      lowFirst = lowLast = apexAt(range.low);
      sides[0] = {{}, gp_Pnt2d(p.u0, range.low), gp_Pnt2d(p.u1, range.low), true, lowFirst};
    } else {
      sides[0] = longSide(p, lowIsOne ? frame.image1 : frame.image2, range.low, lowFirst, lowLast);
    }
    if (range.poleHigh) {
      highFirst = highLast = apexAt(range.high);
      sides[2] = {{}, gp_Pnt2d(p.u0, range.high), gp_Pnt2d(p.u1, range.high), true, highFirst};
    } else {
      sides[2] =
          longSide(p, lowIsOne ? frame.image2 : frame.image1, range.high, highFirst, highLast);
    }
    const auto downTangent = [&](const EdgeSample& end) { return end.tangent.Reversed(); };
    const EdgeSample& a = info.samples.front();
    const EdgeSample& b = info.samples.back();
    sides[3] = endSide(arcs.arc(a.point, downTangent(a), frame.radius, lowFirst, highFirst),
                       lowFirst, p.u0, range);
    sides[1] = endSide(arcs.arc(b.point, downTangent(b), frame.radius, lowLast, highLast), lowLast,
                       p.u1, range);
    faces.push_back(faceFromSides(p.surface, sides, Precision::Confusion()));
  }
  return faces;
}

}  // namespace phront::cad
