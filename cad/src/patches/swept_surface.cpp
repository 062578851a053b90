// Weak spot: where the two normals are opposite a section has no middle, and there is no surface.
#include "patches/swept_surface.h"

#include <BRep_Tool.hxx>
#include <BSplCLib.hxx>
#include <Precision.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array2OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopExp.hxx>
#include <algorithm>
#include <cmath>

namespace phront::cad {
namespace {

constexpr int kDegree = 5;
constexpr int kFewestSpans = 4;
constexpr int kMostSpans = 128;
constexpr int kArcPoints = 9;  // of a short side
// Weights of wider arcs become small: they are made of two.
constexpr double kWidestArc = 2;      // rad
constexpr double kOpposite = 3;       // rad: no middle beyond
constexpr double kWorstError = 1e-3;  // of |d|: worse is none
constexpr double kGoodEnough = 3;  // tolerances of the frame; pieces may be off their level by ten

gp_Pnt onImage(const BRepAdaptor_Curve& image, double share) {
  const double first = image.FirstParameter();
  return image.Value(first + share * (image.LastParameter() - first));
}

}  // namespace

SweptSurface::SweptSurface(const PipeFrame& frame)
    : frame_(frame),
      edge_(frame.info->edge),
      image1_(frame.image1),
      image2_(frame.image2),
      t0_(edge_.FirstParameter()),
      t1_(edge_.LastParameter()) {
  for (int i = 0; i <= kMostSpans && possible_; ++i) {
    const double angle = section(t0_ + (t1_ - t0_) * i / kMostSpans).angle;
    possible_ = angle < kOpposite;
    halves_ = halves_ || angle > kWidestArc;
  }
}

bool SweptSurface::isMetBy(const Geom_Surface& surface) const {
  return error(surface, kFewestSpans) <= kGoodEnough * frame_.tolerance;
}

Handle(Geom_BSplineSurface) SweptSurface::make() const {
  TColStd_Array1OfReal breaks(1, edge_.NbIntervals(GeomAbs_C2) + 1);
  edge_.Intervals(breaks, GeomAbs_C2);
  const int intervals = breaks.Length() - 1;
  Handle(Geom_BSplineSurface) best;
  double least = kWorstError * frame_.radius;
  for (int each = (kFewestSpans + intervals - 1) / intervals;
       each * intervals <= std::max(kMostSpans, intervals); each *= 2) {
    const Handle(Geom_BSplineSurface) surface = interpolated(breaks, each);
    const double off = error(*surface, each * intervals);
    if (off < least) {
      best = surface;
      least = off;
    }
    if (off <= kGoodEnough * frame_.tolerance) break;
  }
  return best;
}

double SweptSurface::across(const gp_Pnt& p, double t) const {
  const Section s = section(t);
  gp_Vec side = gp_Vec(s.a, s.b);
  if (side.Magnitude() < Precision::Confusion()) return 0;
  side.Normalize();
  const gp_Vec arm(s.centre, p);
  const double beta = std::atan2(arm.Dot(side), arm.Dot(s.middle));
  // A symmetric rational arc is linear in the tangent of half the angle.
  if (!halves_) return (1 + std::tan(beta / 2) / std::tan(s.angle / 4)) / 2;
  const double quarter = s.angle / 4;
  const double inHalf = beta < 0 ? beta + quarter : beta - quarter;
  const double local = (1 + std::tan(inHalf / 2) / std::tan(quarter / 2)) / 2;
  return beta < 0 ? local / 2 : (1 + local) / 2;
}

PatchSide SweptSurface::shortSide(double t, const TopoDS_Edge& arc, const TopoDS_Vertex& from,
                                  double start, double end) const {
  if (arc.IsNull()) return {{}, gp_Pnt2d(start, t), gp_Pnt2d(end, t), true, from};
  double first = 0;
  double last = 0;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(arc, first, last);
  std::vector<gp_Pnt2d> points;
  std::vector<double> parameters;
  for (int i = 0; i < kArcPoints; ++i) {
    parameters.push_back(first + (last - first) * i / (kArcPoints - 1));
    points.emplace_back(std::clamp(across(curve->Value(parameters.back()), t), 0.0, 1.0), t);
  }
  const bool forward = TopExp::FirstVertex(arc).IsSame(from);
  points.front().SetX(forward ? start : end);
  points.back().SetX(forward ? end : start);
  return {arc, points.front(), points.back(), false, {}, pcurveThrough(points, parameters)};
}

SweptSurface::Section SweptSurface::section(double t) const {
  const double share = (t - t0_) / (t1_ - t0_);
  Section s;
  s.a = onImage(image1_, share);
  s.b = onImage(image2_, share);
  const gp_Pnt spine = edge_.Value(t);
  const gp_Pnt middle((s.a.XYZ() + s.b.XYZ()) / 2);
  gp_Vec out(spine, middle);
  const gp_Vec chord(s.a, s.b);
  const double half = chord.Magnitude() / 2;
  if (half > Precision::Confusion()) out -= chord * (out.Dot(chord) / chord.SquareMagnitude());
  if (half >= frame_.radius || out.Magnitude() < Precision::Confusion()) {
    s.angle = M_PI;
    return s;
  }
  s.middle = out.Normalized();
  s.centre = middle.Translated(s.middle * -std::sqrt(frame_.radius * frame_.radius - half * half));
  s.angle = 2 * std::asin(half / frame_.radius);
  return s;
}

std::vector<SweptSurface::Pole> SweptSurface::poles(double t) const {
  const Section s = section(t);
  const auto corner = [&](const gp_Vec& direction, double halfAngle) {
    return Pole{s.centre.Translated(direction * (frame_.radius / std::cos(halfAngle))),
                std::cos(halfAngle)};
  };
  if (!halves_) return {{s.a, 1}, corner(s.middle, s.angle / 2), {s.b, 1}};
  const auto between = [&](const gp_Pnt& p) {
    return (gp_Vec(s.centre, p).Normalized() + s.middle).Normalized();
  };
  return {{s.a, 1},
          corner(between(s.a), s.angle / 4),
          {s.centre.Translated(s.middle * frame_.radius), 1},
          corner(between(s.b), s.angle / 4),
          {s.b, 1}};
}

/// `each` spans to an interval between `breaks`, where the curve is only once differentiable.
Handle(Geom_BSplineSurface) SweptSurface::interpolated(const TColStd_Array1OfReal& breaks,
                                                       int each) const {
  std::vector<double> knots;
  std::vector<int> multiplicities;
  for (int i = breaks.Lower(); i < breaks.Upper(); ++i) {
    for (int k = 0; k < each; ++k) {
      knots.push_back(breaks(i) + (breaks(i + 1) - breaks(i)) * k / each);
      multiplicities.push_back(k == 0 ? kDegree - 1 : 1);
    }
  }
  knots.push_back(breaks.Last());
  multiplicities.push_back(kDegree + 1);
  multiplicities.front() = kDegree + 1;

  const auto count = static_cast<int>(knots.size());
  TColStd_Array1OfReal vKnots(1, count);
  TColStd_Array1OfInteger vMultiplicities(1, count);
  int flatCount = 0;
  for (int i = 0; i < count; ++i) {
    vKnots(i + 1) = knots[static_cast<std::size_t>(i)];
    vMultiplicities(i + 1) = multiplicities[static_cast<std::size_t>(i)];
    flatCount += vMultiplicities(i + 1);
  }
  TColStd_Array1OfReal flat(1, flatCount);
  BSplCLib::KnotSequence(vKnots, vMultiplicities, flat);
  const int n = flatCount - kDegree - 1;
  TColStd_Array1OfReal at(1, n);
  BSplCLib::BuildSchoenbergPoints(kDegree, flat, at);
  at(1) = t0_;
  at(n) = t1_;

  const int across = halves_ ? 5 : 3;
  const int dimension = 4 * across;
  TColStd_Array1OfReal values(1, n * dimension);
  for (int i = 1; i <= n; ++i) {
    int next = (i - 1) * dimension;
    for (const Pole& pole : poles(at(i))) {
      for (int k = 1; k <= 3; ++k) values(++next) = pole.weight * pole.point.Coord(k);
      values(++next) = pole.weight;
    }
  }
  TColStd_Array1OfInteger contact(1, n);
  contact.Init(0);
  int problem = 0;
  BSplCLib::Interpolate(kDegree, flat, at, contact, dimension, values(1), problem);
  if (problem != 0) throw Standard_Failure("the sections of a pipe cannot be interpolated");

  TColgp_Array2OfPnt points(1, across, 1, n);
  TColStd_Array2OfReal weights(1, across, 1, n);
  for (int i = 1; i <= n; ++i) {
    for (int k = 1; k <= across; ++k) {
      const int base = (i - 1) * dimension + (k - 1) * 4;
      const double w = values(base + 4);
      weights(k, i) = w;
      points(k, i) = gp_Pnt(values(base + 1) / w, values(base + 2) / w, values(base + 3) / w);
    }
  }
  TColStd_Array1OfReal uKnots(1, halves_ ? 3 : 2);
  TColStd_Array1OfInteger uMultiplicities(1, uKnots.Length());
  for (int k = 1; k <= uKnots.Length(); ++k) {
    uKnots(k) = (k - 1.0) / (uKnots.Length() - 1);
    uMultiplicities(k) = k == 1 || k == uKnots.Length() ? 3 : 2;
  }
  return new Geom_BSplineSurface(points, weights, uKnots, vKnots, uMultiplicities, vMultiplicities,
                                 2, kDegree);
}

/// Between the sections that it was made from, denser than they are.
double SweptSurface::error(const Geom_Surface& surface, int spans) const {
  constexpr int kPerSpan = 6;
  double u0 = 0;
  double u1 = 0;
  double v0 = 0;
  double v1 = 0;
  surface.Bounds(u0, u1, v0, v1);
  double worst = 0;
  for (int i = 0; i < kPerSpan * spans; ++i) {
    const double share = (i + 0.5) / (kPerSpan * spans);
    const Section s = section(t0_ + (t1_ - t0_) * share);
    const double v = v0 + (v1 - v0) * share;
    for (const double across : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      const gp_Pnt p = surface.Value(u0 + (u1 - u0) * across, v);
      worst = std::max(worst, std::abs(p.Distance(s.centre) - frame_.radius));
    }
    const gp_Pnt side1 = surface.Value(u0, v);
    const gp_Pnt side2 = surface.Value(u1, v);
    worst = std::max(worst, std::min(std::max(side1.Distance(s.a), side2.Distance(s.b)),
                                     std::max(side1.Distance(s.b), side2.Distance(s.a))));
  }
  return worst;
}

}  // namespace phront::cad
