#include "tessellate/free_border.h"

#include <BRep_Tool.hxx>
#include <GCPnts_TangentialDeflection.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <limits>

#include "exchange/face_set.h"
#include "patches/edge_table.h"
#include "patches/patch_tools.h"
#include "tessellate/face_surface.h"

namespace phront::cad {
namespace {

constexpr double kTurn = 0.1;     // rad, from one polygon side to the next
constexpr int kNewtonSteps = 12;  // quadratic; more than a start from a polygon needs
constexpr double kSmooth = 1e-3;  // rad: edges that turn by less need no sector

/// Of the way from a to b, where the point nearest to x lies.
double nearestShare(const Vec3& x, const Vec3& a, const Vec3& b) {
  const Vec3 side = b - a;
  return std::clamp((x - a).dot(side) / std::max(side.squaredNorm(), 1e-300), 0.0, 1.0);
}

struct Use {
  TopoDS_Edge edge;
  TopoDS_Face face;
};

}  // namespace

FreeEdge::FreeEdge(const TopoDS_Edge& edge, const TopoDS_Face& face)
    : edge_(edge), face_(face), curve_(edge) {
  double first = 0;
  double last = 0;
  pcurve_ = BRep_Tool::CurveOnSurface(edge, face, first, last);
}

std::optional<BorderPoint> FreeEdge::at(double parameter) const {
  gp_Pnt point;
  gp_Vec tangent;
  curve_.D1(parameter, point, tangent);
  if (pcurve_.IsNull() || tangent.Magnitude() < gp::Resolution()) return std::nullopt;
  const std::optional<gp_Vec> normal = outwardNormal(face_, pcurve_->Value(parameter));
  if (!normal) return std::nullopt;
  return BorderPoint{toVec3(point.XYZ()), toVec3(normal->XYZ()),
                     toVec3(tangent.Normalized().XYZ())};
}

FreeBorder::FreeBorder(const TopoDS_Shape& sheet, double chord) {
  TopTools_IndexedMapOfShape known;
  std::vector<std::vector<Use>> uses;
  for (const TopoDS_Face& face : facesOf(sheet)) {
    for (const TopoDS_Edge& edge : edgesOf(face)) {
      const bool inside =
          edge.Orientation() == TopAbs_INTERNAL || edge.Orientation() == TopAbs_EXTERNAL;
      if (BRep_Tool::Degenerated(edge) || inside) continue;
      const auto number = static_cast<std::size_t>(known.Add(edge));
      if (number > uses.size()) uses.emplace_back();
      uses[number - 1].push_back({edge, face});
    }
  }
  for (const std::vector<Use>& use : uses) {
    const bool clash = use.size() == 2 && use[0].edge.Orientation() == use[1].edge.Orientation();
    if (use.size() > 2 || clash) ++badEdges_;
    if (use.size() == 1) edges_.emplace_back(use[0].edge, use[0].face);
  }
  TopTools_IndexedMapOfShape ends;
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    TopExp::MapShapes(edges_[e].edge(), TopAbs_VERTEX, ends);
    GCPnts_TangentialDeflection points(edges_[e].curve(), kTurn, chord);
    for (int i = 1; i < points.NbPoints(); ++i)
      segments_.push_back({toVec3(points.Value(i).XYZ()), toVec3(points.Value(i + 1).XYZ()),
                           points.Parameter(i), points.Parameter(i + 1), e});
  }
  const EdgeTable table = makeEdgeTable(sheet, 1, kSmooth);
  for (const EdgeInfo& info : table.edges) {
    if (info.samples.empty() || info.smooth) continue;
    TopoDS_Vertex first;
    TopoDS_Vertex last;
    TopExp::Vertices(info.edge, first, last);
    for (const bool atFirst : {true, false}) {
      if (!ends.Contains(atFirst ? first : last)) continue;
      const EdgeSample& s = atFirst ? info.samples.front() : info.samples.back();
      if (std::abs(s.angle) < kSmooth) continue;
      ridgeEnds_.push_back({toVec3(s.point.XYZ()), toVec3(s.tangent.XYZ()), toVec3(s.n1.XYZ()),
                            toVec3(s.n2.XYZ()), s.angle > 0});
    }
  }
}

double FreeBorder::parameterNear(const Vec3& x, const Segment& segment) const {
  const BRepAdaptor_Curve& curve = edges_[segment.edge].curve();
  const double start =
      segment.first + nearestShare(x, segment.from, segment.to) * (segment.last - segment.first);
  const double reach = std::abs(segment.last - segment.first);
  const double low =
      std::max(curve.FirstParameter(), std::min(segment.first, segment.last) - reach);
  const double high =
      std::min(curve.LastParameter(), std::max(segment.first, segment.last) + reach);
  double t = start;
  for (int i = 0; i < kNewtonSteps; ++i) {
    gp_Pnt point;
    gp_Vec d1;
    gp_Vec d2;
    curve.D2(t, point, d1, d2);
    const gp_Vec arm(gp_Pnt(x.x(), x.y(), x.z()), point);
    const double slope = d1.SquareMagnitude() + arm.Dot(d2);
    if (!(slope > 0)) break;
    const double next = std::clamp(t - arm.Dot(d1) / slope, low, high);
    if (next == t) break;
    t = next;
  }
  const auto distance = [&](double at) { return (toVec3(curve.Value(at).XYZ()) - x).norm(); };
  return distance(t) <= distance(start) ? t : start;
}

std::optional<BorderPoint> FreeBorder::nearest(const Vec3& x) const {
  const Segment* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Segment& segment : segments_) {
    const double share = nearestShare(x, segment.from, segment.to);
    const double squared = (segment.from + share * (segment.to - segment.from) - x).squaredNorm();
    if (squared >= least) continue;
    least = squared;
    best = &segment;
  }
  if (best == nullptr) return std::nullopt;
  return edges_[best->edge].at(parameterNear(x, *best));
}

}  // namespace phront::cad
