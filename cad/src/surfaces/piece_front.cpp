#include "surfaces/piece_front.h"

#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <Precision.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "tessellate/face_surface.h"

namespace phront::cad {
namespace {

constexpr double kCutShare = 0.4;    // of the tolerance: nearer than |d| by this: cut off
constexpr double kChordShare = 0.2;  // of the tolerance: the cut lines from the true ones
constexpr double kGridPitch = 2;     // |d| between samples inside
constexpr int kMostGrid = 64;
constexpr double kBorderPitch = 0.5;  // |d| between samples on loops
constexpr int kLeastOnEdge = 8;
constexpr int kMostOnEdge = 200;
constexpr double kLongestStep = 1;  // |d|, of lines
constexpr int kInwardDoublings = 16;
constexpr double kMargin = 0.01;  // of the domain: how far lines run beyond it
constexpr double kMeshSlack = 4;  // times the measured deflection: error of triangle distances

Vec2 vec2(const gp_Pnt2d& p) { return {p.X(), p.Y()}; }

ParameterPlane planeFor(const Geom_Surface& surface, const ParameterBox& box) {
  // Typical lengths, that the plane resembles the surface.
  double u = 0;
  double v = 0;
  constexpr int kSamples = 5;
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) {
      const auto at = [&](const Interval& t, int k) {
        return t.low + (t.high - t.low) * (k + 0.5) / kSamples;
      };
      gp_Pnt p;
      gp_Vec du;
      gp_Vec dv;
      surface.D1(at(box.u, i), at(box.v, j), p, du, dv);
      u = std::max(u, du.Magnitude());
      v = std::max(v, dv.Magnitude());
    }
  }
  return {u > 0 ? u : 1, v > 0 ? v : 1};
}

/// Creases and ripples lie along them, narrower than the samples between.
std::vector<double> innerKnots(const GeomAdaptor_Surface& surface, bool alongU) {
  const int spans = alongU ? surface.NbUIntervals(GeomAbs_CN) : surface.NbVIntervals(GeomAbs_CN);
  if (spans < 2 || spans > kMostGrid) return {};
  TColStd_Array1OfReal ends(1, spans + 1);
  if (alongU)
    surface.UIntervals(ends, GeomAbs_CN);
  else
    surface.VIntervals(ends, GeomAbs_CN);
  return {std::next(ends.begin()), std::prev(ends.end())};
}

}  // namespace

PieceFront::PieceFront(const TopoDS_Face& domain, const Handle(Geom_Surface) & surface,
                       const ParameterBox& box, const TrimRequest& request, const TrueDistance& phi)
    : face_(TopoDS::Face(domain.Oriented(TopAbs_FORWARD))),
      inFace_(face_, Precision::PConfusion()),
      surface_(surface),
      request_(request),
      phi_(phi),
      plane_(planeFor(*surface, box)) {
  for (const FaceFeature& f : phi.tessellation().features.faces)
    meshSlack_ = std::max(meshSlack_, kMeshSlack * f.deflection);
  const GeomAdaptor_Surface original(BRep_Tool::Surface(face_));
  for (const Eigen::Index k : {0, 1}) {
    knots_[static_cast<std::size_t>(k)] = innerKnots(original, k == 0);
    for (double& knot : knots_[static_cast<std::size_t>(k)]) knot *= plane_.scale()[k];
  }
  low_ = plane_.toPlane({box.u.low, box.v.low});
  high_ = plane_.toPlane({box.u.high, box.v.high});
}

double PieceFront::chord() const { return kChordShare * request_.tolerance; }
double PieceFront::cut() const { return kCutShare * request_.tolerance; }

Vec3 PieceFront::pointAt(const Vec2& x) const {
  const Vec2 uv = plane_.fromPlane(x);
  return toVec3(surface_->Value(uv[0], uv[1]).XYZ());
}

/// Distance from the shape on the side where the offset belongs.
double PieceFront::level(const Vec2& x) const {
  const TrueDistance::Foot foot = phi_.foot(pointAt(x));
  return request_.solid ? std::copysign(1, request_.distance) * foot.sign * foot.distance
                        : foot.distance;
}

Clearance PieceFront::clearance(const Vec2& x) const {
  const Vec2 uv = plane_.fromPlane(x);
  gp_Pnt p;
  gp_Vec du;
  gp_Vec dv;
  surface_->D1(uv[0], uv[1], p, du, dv);
  const Vec3 q = toVec3(p.XYZ());
  const TrueDistance::Foot foot = phi_.foot(q);
  const double side = request_.solid ? std::copysign(1, request_.distance) * foot.sign : 1;
  const Vec3 up = side * (q - foot.point).normalized();
  return {
      side * foot.distance - std::abs(request_.distance) + cut(),
      {up.dot(toVec3(du.XYZ())) / plane_.scale()[0], up.dot(toVec3(dv.XYZ())) / plane_.scale()[1]}};
}
bool PieceFront::valid(const Vec2& x) const {
  const double least = std::abs(request_.distance) - cut();
  // Mostly the triangles tell already.
  if (phi_.surface().foot(pointAt(x)).distance + meshSlack_ < least) return false;
  return level(x) >= least;
}
bool PieceFront::inFace(const Vec2& x) {
  const Vec2 uv = plane_.fromPlane(x);
  const TopAbs_State state = inFace_.Perform(gp_Pnt2d(uv[0], uv[1]));
  return state == TopAbs_IN || state == TopAbs_ON;
}
bool PieceFront::inBox(const Vec2& x) const {
  return (x.array() >= low_.array()).all() && (x.array() <= high_.array()).all();
}

int PieceFront::cellsFor(double length, int least) const {
  return static_cast<int>(std::clamp(length / (kGridPitch * std::abs(request_.distance)),
                                     double(least), double(kMostGrid)));
}

std::vector<double> PieceFront::withKnots(Eigen::Index axis, const Interval& range,
                                          std::vector<double> values) const {
  for (const double knot : knots_[static_cast<std::size_t>(axis)])
    if (range.low < knot && knot < range.high) values.push_back(knot);
  std::sort(values.begin(), values.end());
  return values;
}

std::vector<double> PieceFront::middles(Eigen::Index axis, const Interval& range, int count) const {
  std::vector<double> values;
  for (int i = 0; i < count; ++i)
    values.push_back(range.low + (range.high - range.low) * (i + 0.5) / count);
  return withKnots(axis, range, std::move(values));
}

void PieceFront::sampleInside(int least, bool beyond) {
  const Vec2 size = high_ - low_;
  const std::vector<double> us = middles(0, {low_[0], high_[0]}, cellsFor(size[0], least));
  const std::vector<double> vs = middles(1, {low_[1], high_[1]}, cellsFor(size[1], least));
  const std::size_t nu = us.size();
  struct Node {
    Vec2 at;
    bool inside = false, valid = false;
  };
  std::vector<Node> nodes;
  for (const double v : vs) {
    for (const double u : us) {
      Node node{{u, v}};
      node.inside = inFace(node.at);
      node.valid = valid(node.at);
      if (node.inside && node.valid) ++valid_;
      nodes.push_back(node);
    }
  }
  const auto look = [&](const Node& a, const Node& b) {
    if (a.valid == b.valid) return;
    if (beyond ? !a.inside && !b.inside : !a.inside || !b.inside) return;
    seeds_.push_back(a.valid ? ContourSeed{b.at, a.at} : ContourSeed{a.at, b.at});
  };
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (n % nu > 0) look(nodes[n - 1], nodes[n]);
    if (n >= nu) look(nodes[n - nu], nodes[n]);
  }
}

/// Fronts of neighbours cut a face off along its edges first.
void PieceFront::sampleLoops() {
  for (TopExp_Explorer it(face_, TopAbs_EDGE); it.More(); it.Next()) {
    const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
    double first = 0;
    double last = 0;
    const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face_, first, last);
    if (curve.IsNull()) continue;
    const auto at = [&](double share) {
      return plane_.toPlane(vec2(curve->Value(first + share * (last - first))));
    };
    double length = 0;
    for (int i = 0; i < kLeastOnEdge; ++i)
      length += (at(double(i + 1) / kLeastOnEdge) - at(double(i) / kLeastOnEdge)).norm();
    const int count =
        static_cast<int>(std::clamp(length / (kBorderPitch * std::abs(request_.distance)),
                                    double(kLeastOnEdge), double(kMostOnEdge)));
    struct Sample {
      Vec2 at = Vec2::Zero();
      bool here = false, valid = false;
    };
    std::vector<Sample> samples;
    for (int i = 0; i <= count; ++i) {
      Sample sample{at(double(i) / count)};
      sample.here = inBox(sample.at);
      sample.valid = sample.here && valid(sample.at);
      samples.push_back(sample);
    }
    const double forward = edge.Orientation() == TopAbs_REVERSED ? -1 : 1;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Sample& sample = samples[i];
      if (!sample.here) continue;
      if (i > 0 && samples[i - 1].here && sample.valid != samples[i - 1].valid)
        seeds_.push_back(sample.valid ? ContourSeed{samples[i - 1].at, sample.at}
                                      : ContourSeed{sample.at, samples[i - 1].at});
      if (sample.valid) continue;
      const std::size_t last = std::min(i + 1, samples.size() - 1);
      const Vec2 along = forward * (samples[last].at - samples[i > 0 ? i - 1 : 0].at);
      if (along.norm() > 0) seedInwards(sample.at, Vec2(-along[1], along[0]).normalized());
    }
  }
}

/// From an invalid point of a loop to the first valid one inside.
void PieceFront::seedInwards(const Vec2& x, const Vec2& inward) {
  Vec2 last = x;
  double step = chord();
  const double reach = (high_ - low_).norm();
  for (int k = 0; k < kInwardDoublings && step < reach; ++k, step *= 2) {
    const Vec2 next = x + step * inward;
    // Near a curved loop the classifier, which goes by polygons, may err.
    if (!inFace(next)) continue;
    if (valid(next)) {
      ++valid_;
      seeds_.push_back({last, next});
      return;
    }
    last = next;
  }
}

ContourOptions PieceFront::lineOptions() const {
  ContourOptions options;
  const Vec2 margin = kMargin * (high_ - low_);
  options.low = low_ - margin;
  options.high = high_ + margin;
  options.chord = chord();
  options.longestStep = kLongestStep * std::abs(request_.distance);
  return options;
}

void PieceFront::traceLines(std::vector<Contour>& lines) const {
  traceContours(clearance_, seeds_, lineOptions(), lines);
}

std::vector<Contour> PieceFront::gridLines(int cells) const {
  const ContourOptions options = lineOptions();
  const auto along = [&](Eigen::Index axis) {
    std::vector<double> values;
    for (int i = 0; i <= cells; ++i)
      values.push_back(options.low[axis] + (options.high[axis] - options.low[axis]) * i / cells);
    return withKnots(axis, {options.low[axis], options.high[axis]}, std::move(values));
  };
  return gridContours(clearance_, options.chord, along(0), along(1));
}

}  // namespace phront::cad
