// Feet on edges: nearest segment of the edge's polygon, then Newton on (C(t) - x) . C'(t) = 0, kept
// in the edge's range and halved until the distance falls.
#include "patches/trimmed_face.h"

#include <BRep_Tool.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>

namespace phront::cad {
namespace {

constexpr int kNewtonSteps = 30;
constexpr double kOnBorder = 1e-9;    // of the parameter plane
constexpr double kConverged = 1e-12;  // step, of the parameter range

}  // namespace

ExactEdge::ExactEdge(const TopoDS_Edge& edge, Index number, Index firstVertex, Index lastVertex)
    : number_(number), firstVertex_(firstVertex), lastVertex_(lastVertex) {
  tolerance_ = BRep_Tool::Tolerance(edge);
  if (BRep_Tool::Degenerated(edge)) return;
  BRepAdaptor_Curve curve(TopoDS::Edge(edge.Oriented(TopAbs_FORWARD)));
  first_ = curve.FirstParameter();
  last_ = curve.LastParameter();
  if (!std::isfinite(first_) || !std::isfinite(last_) || !(first_ < last_)) return;
  straight_ = curve.GetType() == GeomAbs_Line;
  curve_ = std::move(curve);
}

void ExactEdge::setSegments(std::vector<Segment> segments) {
  segments_ = std::move(segments);
  for (const Segment& s : segments_) {
    box_.extend(s.from);
    box_.extend(s.to);
    if (!curve_) continue;
    const Vec3 middle = toVec3(curve_->Value(0.5 * (s.first + s.last)).XYZ());
    const Vec3 along = s.to - s.from;
    const double t =
        std::clamp(along.dot(middle - s.from) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
    chord_ = std::max(chord_, (middle - s.from - t * along).norm());
  }
}

std::pair<double, std::size_t> ExactEdge::nearestSegment(const Vec3& x) const {
  double best = std::numeric_limits<double>::infinity();
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    const Segment& s = segments_[i];
    const Vec3 along = s.to - s.from;
    const double t =
        std::clamp(along.dot(x - s.from) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
    const double squared = (x - s.from - t * along).squaredNorm();
    if (squared >= best) continue;
    best = squared;
    nearest = i;
  }
  return {std::sqrt(best), nearest};
}

EdgeFoot ExactEdge::foot(const Vec3& x, std::size_t segment) const {
  const Segment& s = segments_[segment];
  const Vec3 along = s.to - s.from;
  const double share =
      std::clamp(along.dot(x - s.from) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
  const double start = std::clamp(s.first + share * (s.last - s.first), first_, last_);
  EdgeFoot foot = newton(x, start);
  // A closed edge goes on where its range ends.
  const bool closed = firstVertex_ == lastVertex_;
  if (closed && foot.parameter - first_ <= kConverged * (last_ - first_)) {
    const EdgeFoot other = newton(x, last_);
    if (other.distance < foot.distance) foot = other;
  } else if (closed && last_ - foot.parameter <= kConverged * (last_ - first_)) {
    const EdgeFoot other = newton(x, first_);
    if (other.distance < foot.distance) foot = other;
  }
  const double speed = std::max(tangent(foot.parameter).norm(), 1e-300);
  const double tie = std::min(2 * tolerance_ / speed, 0.25 * (last_ - first_));
  if (foot.parameter - first_ <= tie) foot.vertex = firstVertex_;
  if (last_ - foot.parameter <= tie) foot.vertex = lastVertex_;
  return foot;
}

EdgeFoot ExactEdge::newton(const Vec3& x, double t) const {
  EdgeFoot foot;
  foot.edge = number_;
  gp_Pnt p;
  gp_Vec d1, d2;
  for (int step = 0; step < kNewtonSteps; ++step) {
    curve_->D2(t, p, d1, d2);
    const Vec3 point = toVec3(p.XYZ());
    const Vec3 tangent = toVec3(d1.XYZ());
    const Vec3 r = point - x;
    foot.point = point;
    foot.distance = r.norm();
    foot.parameter = t;
    const double slope = r.dot(tangent);
    const double speed = tangent.squaredNorm();
    double curvature = speed + r.dot(toVec3(d2.XYZ()));
    if (!(curvature > 1e-6 * speed)) curvature = speed;
    if (!(curvature > 0)) break;
    const double full = std::clamp(t - slope / curvature, first_, last_) - t;
    if (std::abs(full) <= kConverged * (last_ - first_)) break;
    double factor = 1;
    bool moved = false;
    for (int halving = 0; halving < 12 && !moved; ++halving, factor *= 0.5) {
      const double next = t + factor * full;
      if ((toVec3(curve_->Value(next).XYZ()) - x).norm() >= foot.distance) continue;
      t = next;
      moved = true;
    }
    if (!moved) break;
  }
  return foot;
}

Vec3 ExactEdge::tangent(double parameter) const {
  gp_Pnt p;
  gp_Vec d;
  curve_->D1(parameter, p, d);
  return toVec3(d.XYZ());
}

TrimmedFace::TrimmedFace(const TopoDS_Face& face, std::vector<Index> border)
    : face_(face), surface_(face), border_(std::move(border)) {}

bool TrimmedFace::hasBorder(Index edge) const {
  return std::find(border_.begin(), border_.end(), edge) != border_.end();
}

bool TrimmedFace::contains(const Eigen::Vector2d& uv) const {
  if (!domain_) domain_ = std::make_unique<BRepTopAdaptor_FClass2d>(face_, kOnBorder);
  const TopAbs_State state = domain_->Perform(gp_Pnt2d(uv.x(), uv.y()));
  return state == TopAbs_IN || state == TopAbs_ON;
}

}  // namespace phront::cad
