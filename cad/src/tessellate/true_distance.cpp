// Distance to the exact B-Rep.
//
// The nearest triangle names a face and parameters on it; the foot on the face's untrimmed surface
// (closed form or Newton) counts if it lies in the trimmed domain, else the foot on the face's
// border curves does. Far from the border the triangles know the domain; within their chordal error
// of it the parameter plane decides: the nearest border point does not, as where a face meets
// itself borders lie on one another. As triangles deviate from their faces, every other face whose
// triangles come within the best distance plus twice its own deflection is tried too. A refined
// foot is accepted only if its distance agrees with the triangles' within a few chordal errors, so
// that a Newton iteration gone astray costs accuracy, never correctness. Weak spots: the measured
// deflection is a sample; where it is too small, a nearer face may be missed by the difference.
#include "tessellate/true_distance.h"

#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>

#include "exchange/guard.h"
#include "patches/trimmed_face.h"
#include "tessellate/features.h"

namespace phront::cad {
namespace {

constexpr double kChordFactor = 4;   // accepted disagreement with the triangles, chordal errors
constexpr double kReachFactor = 2;   // of a face's deflection: measured on a sample only
constexpr double kRoundOff = 1e-11;  // of the diagonal: distances closer than this are equal
constexpr double kResidual = 1e-10;  // of the diagonal: tangential residual of Newton
constexpr double kRingShare = 0.25;  // a foot this far outside a triangle is still in its ring
constexpr double kDoubt = 0.1;       // of a face's deflection: a foot so much farther is doubted
constexpr int kLineSamples = 24;     // on a parameter line across a triangle
constexpr double kNudge = 1e-7;      // of the way to the triangle's middle, off singular points

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

// How a triangle touches the border of its face.
enum : std::uint8_t {
  kTouchesBorder = 1,     // a corner on the border
  kCurvedBorderSide = 2,  // a side on a border edge that is not straight
};

struct Candidate {
  double distance = std::numeric_limits<double>::infinity();
  Vec3 point = Vec3::Zero();
  Feature feature;
  Index face = kNone;
  Index edge = kNone;  // the foot lies on this edge, sharp or smooth
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();
  double parameter = 0;  // on the edge
  Index vertex = kNone;  // the foot is this end of the edge, sharp or smooth
};

// Barycentric coordinates of a point in a triangle of the parameter plane.
bool barycentricIn(const std::array<Eigen::Vector2d, 3>& t, const Eigen::Vector2d& p,
                   Vec3& barycentric) {
  const Eigen::Vector2d a = t[1] - t[0];
  const Eigen::Vector2d b = t[2] - t[0];
  const Eigen::Vector2d c = p - t[0];
  const double area = a.x() * b.y() - a.y() * b.x();
  if (area == 0 || !std::isfinite(area)) return false;
  const double v = (c.x() * b.y() - c.y() * b.x()) / area;
  const double w = (a.x() * c.y() - a.y() * c.x()) / area;
  barycentric = Vec3(1 - v - w, v, w);
  return true;
}

}  // namespace

struct TrueDistance::Impl {
  Impl(Tessellation t, SurfaceDistance s) : tessellation(std::move(t)), surface(std::move(s)) {}

  Tessellation tessellation;
  SurfaceDistance surface;
  std::vector<std::unique_ptr<TrimmedFace>> faces;
  std::vector<Box3> faceBoxes;
  std::vector<double> slack;  // per face, how far its triangles may miss it, borders included
  std::vector<ExactEdge> edges;
  std::vector<std::vector<EdgeUse>> usesOfEdge;
  std::vector<std::vector<Index>> apices;  // per face, vertices of its degenerated edges
  std::vector<bool> sharpVertex;
  std::vector<std::uint8_t> touch;  // per triangle
  double diagonal = 1;

  void indexShape(const TopoDS_Shape& shape);
  void indexTriangles();
  [[nodiscard]] bool insideDomain(Index face, Index triangle, const Eigen::Vector2d& uv,
                                  const Vec3& point) const;
  [[nodiscard]] Candidate borderFoot(const Vec3& x, Index face) const;
  [[nodiscard]] Candidate meshCandidate(const FootPoint& foot) const;
  [[nodiscard]] SurfaceFoot footFrom(const Vec3& x, const FootPoint& foot,
                                     const Candidate& start) const;
  [[nodiscard]] Candidate refine(const Vec3& x, const FootPoint& foot) const;
  [[nodiscard]] double signAt(const Vec3& x, const Candidate& c, double meshSign) const;
  [[nodiscard]] const FaceFeature& faceFeature(Index f) const {
    return tessellation.features.faces[at(f)];
  }
};

void TrueDistance::Impl::indexShape(const TopoDS_Shape& shape) {
  ShapeIndex index(shape);
  std::vector<std::vector<Index>> border(index.surfaces.size());
  apices.resize(index.surfaces.size());
  for (std::size_t e = 0; e < index.uses.size(); ++e) {
    const TopoDS_Edge& edge = TopoDS::Edge(index.maps.edges(static_cast<int>(e) + 1));
    const auto vertex = [&](const TopoDS_Vertex& v) {
      return v.IsNull() ? kNone : static_cast<Index>(index.maps.vertices.FindIndex(v) - 1);
    };
    const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
    const Index first = vertex(TopExp::FirstVertex(forward));
    edges.emplace_back(edge, static_cast<Index>(e), first, vertex(TopExp::LastVertex(forward)));
    const std::vector<EdgeUse>& uses = index.uses[e];
    for (std::size_t i = 0; i < uses.size(); ++i) {
      const std::size_t f = at(uses[i].faceIndex);
      if (BRep_Tool::Degenerated(edge)) {
        if (first != kNone) apices[f].push_back(first);
        continue;
      }
      const auto inFace = std::count_if(uses.begin(), uses.end(), [&](const EdgeUse& u) {
        return u.faceIndex == uses[i].faceIndex;
      });
      if (inFace != 1) continue;  // seams are no border
      border[f].push_back(static_cast<Index>(e));
    }
  }
  for (std::size_t f = 0; f < border.size(); ++f) {
    const TopoDS_Face& face = TopoDS::Face(index.maps.faces(static_cast<int>(f) + 1));
    faces.push_back(std::make_unique<TrimmedFace>(face, std::move(border[f])));
  }
  usesOfEdge = std::move(index.uses);
}

void TrueDistance::Impl::indexTriangles() {
  const TriMesh& mesh = tessellation.mesh;
  diagonal = boundingBox(mesh).diagonal().norm();
  faceBoxes.resize(faces.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const Index c : mesh.triangles[t]) {
      faceBoxes[at(mesh.faceOf[t])].extend(mesh.points[at(c)]);
    }
  }
  sharpVertex.assign(tessellation.features.vertices.size(), false);
  for (const Index v : mesh.vertexOf) {
    if (v != kNone) sharpVertex[at(v)] = true;
  }
  touch.assign(mesh.triangles.size(), 0);
  std::vector<bool> onEdge(mesh.points.size(), false);
  std::vector<std::vector<ExactEdge::Segment>> segments(edges.size());
  std::vector<Index> leader(edges.size(), kNone);  // the face whose sides make the polygon
  for (const EdgeSide& s : tessellation.edgeSides) {
    const Index face = mesh.faceOf[at(s.triangle)];
    const Index from = mesh.triangles[at(s.triangle)][at(s.side)];
    const Index to = mesh.triangles[at(s.triangle)][at((s.side + 1) % 3)];
    if (faces[at(face)]->hasBorder(s.edge)) {
      onEdge[at(from)] = onEdge[at(to)] = true;
      if (!edges[at(s.edge)].straight()) touch[at(s.triangle)] |= kCurvedBorderSide;
    }
    if (leader[at(s.edge)] == kNone) leader[at(s.edge)] = face;
    if (leader[at(s.edge)] != face) continue;
    segments[at(s.edge)].push_back({mesh.points[at(from)], mesh.points[at(to)], s.first, s.last});
  }
  for (std::size_t e = 0; e < edges.size(); ++e) edges[e].setSegments(std::move(segments[e]));
  for (std::size_t f = 0; f < faces.size(); ++f) {
    slack.push_back(tessellation.features.faces[f].deflection);
    for (const Index e : faces[f]->border()) {
      slack[f] = std::max(slack[f], edges[at(e)].chord() + edges[at(e)].tolerance());
    }
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const Index c : mesh.triangles[t]) {
      if (onEdge[at(c)]) touch[t] |= kTouchesBorder;
    }
  }
}

// Inside a triangle, or inside the ring around one that has no corner on the border, the answer is
// known. `point` is the point of the surface at `uv`.
bool TrueDistance::Impl::insideDomain(Index face, Index triangle, const Eigen::Vector2d& uv,
                                      const Vec3& point) const {
  Vec3 b;
  if (barycentricIn(tessellation.uv[at(triangle)], uv, b)) {
    const std::uint8_t flags = touch[at(triangle)];
    if (!(flags & kTouchesBorder) && b.minCoeff() > -kRingShare) return true;
    if (!(flags & kCurvedBorderSide) && b.minCoeff() > 0) return true;
  }
  const Candidate border = borderFoot(point, face);
  if (!std::isfinite(border.distance)) return true;  // a closed surface
  const double tie = border.edge == kNone ? 0 : 2 * edges[at(border.edge)].tolerance();
  if (border.distance <= tie) return true;
  const double unsure = kChordFactor * slack[at(face)];
  if (border.distance > unsure + tie) {
    const FootPoint onMesh = surface.footOnFace(point, face, border.distance);
    return onMesh.triangle != kNone && onMesh.distance < 0.5 * border.distance;
  }
  return faces[at(face)]->contains(uv);
}

Candidate TrueDistance::Impl::borderFoot(const Vec3& x, Index face) const {
  struct Near {
    double distance;
    Index edge;
    std::size_t segment;
  };
  std::vector<Near> near;
  double best = std::numeric_limits<double>::infinity();
  for (const Index e : faces[at(face)]->border()) {
    const ExactEdge& edge = edges[at(e)];
    if (!edge.usable() || edge.box().exteriorDistance(x) > best + 2 * edge.chord()) continue;
    const auto [distance, segment] = edge.nearestSegment(x);
    best = std::min(best, distance + 2 * edge.chord());
    near.push_back({distance, e, segment});
  }
  Candidate result;
  result.face = face;
  const auto& features = tessellation.features;
  for (const Near& n : near) {
    if (n.distance - 2 * edges[at(n.edge)].chord() > best) continue;
    const EdgeFoot foot = edges[at(n.edge)].foot(x, n.segment);
    if (!(foot.distance < result.distance)) continue;
    result.distance = foot.distance;
    result.point = foot.point;
    result.edge = n.edge;
    result.parameter = foot.parameter;
    result.vertex = foot.vertex;
    if (foot.vertex != kNone && sharpVertex[at(foot.vertex)]) {
      result.feature = {FeatureKind::Vertex, foot.vertex};
    } else if (isSharp(features.edges[at(n.edge)].type)) {
      result.feature = {FeatureKind::Edge, n.edge};
    } else {
      result.feature = {FeatureKind::Face, face};
    }
  }
  for (const Index v : apices[at(face)]) {
    const Vec3& point = features.vertices[at(v)].point;
    const double distance = (x - point).norm();
    if (!(distance < result.distance)) continue;
    result.distance = distance;
    result.point = point;
    result.edge = kNone;
    result.feature =
        sharpVertex[at(v)] ? Feature{FeatureKind::Vertex, v} : Feature{FeatureKind::Face, face};
  }
  return result;
}

Candidate TrueDistance::Impl::meshCandidate(const FootPoint& foot) const {
  Candidate c;
  c.distance = foot.distance;
  c.point = foot.point;
  c.feature = surface.featureOf(foot);
  c.face = tessellation.mesh.faceOf[at(foot.triangle)];
  const auto& uv = tessellation.uv[at(foot.triangle)];
  c.uv = foot.barycentric[0] * uv[0] + foot.barycentric[1] * uv[1] + foot.barycentric[2] * uv[2];
  return c;
}

// Where a face turns back or collapses, the parameters of a point of a triangle may be those of
// another sheet: when the foot is farther than the triangle, and not by a little, it is sought from
// the nearest point on the parameter lines through the first guess, too.
SurfaceFoot TrueDistance::Impl::footFrom(const Vec3& x, const FootPoint& foot,
                                         const Candidate& start) const {
  const FaceSurface& face = faces[at(start.face)]->surface();
  const SurfaceFoot first = face.foot(x, kResidual * diagonal, start.uv);
  const double distance = (first.point - x).norm();
  if (distance <= start.distance + kDoubt * slack[at(start.face)]) return first;
  const auto& corners = tessellation.uv[at(foot.triangle)];
  Eigen::Vector2d nearest = start.uv;
  double least = std::numeric_limits<double>::infinity();
  for (const int along : {0, 1}) {
    const auto [low, high] = std::minmax({corners[0][along], corners[1][along], corners[2][along]});
    for (int i = 0; i <= kLineSamples; ++i) {
      Eigen::Vector2d uv = start.uv;
      uv[along] = std::lerp(low, high, static_cast<double>(i) / kLineSamples);
      const double off = (face.point(uv) - x).squaredNorm();
      if (off >= least) continue;
      least = off;
      nearest = uv;
    }
  }
  const SurfaceFoot second = face.foot(x, kResidual * diagonal, nearest);
  return (second.point - x).norm() < distance ? second : first;
}

Candidate TrueDistance::Impl::refine(const Vec3& x, const FootPoint& foot) const {
  const Candidate start = meshCandidate(foot);
  Candidate result = start;
  const SurfaceFoot onFace = footFrom(x, foot, start);
  result.uv = onFace.uv;
  result.point = onFace.point;
  const bool inside =
      !onFace.atBound && insideDomain(start.face, foot.triangle, result.uv, result.point);
  if (inside) {
    result.distance = (x - result.point).norm();
    result.feature = {FeatureKind::Face, start.face};
  }
  // At a centre of curvature feet are too flat to converge: no farther than this one they are.
  if (!inside || !onFace.converged) {
    const Candidate border = borderFoot(x, start.face);
    if (!inside || border.distance <= result.distance) result = border;
  }
  const double allowed = kChordFactor * (slack[at(start.face)] + kRoundOff * diagonal);
  return std::abs(result.distance - start.distance) <= allowed ? result : start;
}

// Within the chordal error the triangles may have x on the wrong side: ask the exact normals.
double TrueDistance::Impl::signAt(const Vec3& x, const Candidate& c, double meshSign) const {
  Vec3 point;
  Vec3 normal = Vec3::Zero();
  if (c.edge != kNone && c.feature.kind != FeatureKind::Vertex) {
    for (const EdgeUse& use : usesOfEdge[at(c.edge)]) {
      double first = 0;
      double last = 0;
      const Handle(Geom2d_Curve) pcurve =
          BRep_Tool::CurveOnSurface(use.edge, use.face, first, last);
      if (pcurve.IsNull()) continue;
      const gp_Pnt2d uv = pcurve->Value(std::clamp(c.parameter, first, last));
      Vec3 n;
      if (faces[at(use.faceIndex)]->surface().pointAndNormal({uv.X(), uv.Y()}, point, n))
        normal += n;
    }
  } else if (c.feature.kind == FeatureKind::Face) {
    if (!faces[at(c.face)]->surface().pointAndNormal(c.uv, point, normal)) return meshSign;
  }
  const double side = normal.dot(x - c.point);
  if (side == 0) return meshSign;
  return side > 0 ? 1 : -1;
}

Result<TrueDistance> TrueDistance::build(const TopoDS_Shape& shape, Tessellation tessellation) {
  TopExp_Explorer solid(shape, TopAbs_SOLID);
  if (solid.More()) solid.Next();
  const bool several = solid.More();
  auto surface =
      SurfaceDistance::build(tessellation.mesh, several ? SignRule::Union : SignRule::Topology);
  if (!surface) return tl::unexpected(surface.error());
  return guardOcct("preparing exact distances", [&]() -> Result<TrueDistance> {
    auto impl = std::make_unique<Impl>(std::move(tessellation), std::move(*surface));
    impl->indexShape(shape);
    const FeatureTable& table = impl->tessellation.features;
    if (impl->faces.size() != table.faces.size() || impl->edges.size() != table.edges.size()) {
      return fail(ErrorCode::InvalidArgument,
                  "The tessellation stems from another shape: their features differ in number.");
    }
    impl->indexTriangles();
    return TrueDistance(std::move(impl));
  });
}

TrueDistance::Foot TrueDistance::foot(const Vec3& x) const {
  const Impl& s = *impl_;
  const FootPoint mesh = s.surface.foot(x);
  Foot result;
  result.distance = result.meshDistance = mesh.distance;
  result.point = mesh.point;
  result.sign = mesh.sign;
  result.beyondBorder = mesh.beyondBorder;
  if (mesh.triangle == kNone) return result;
  try {
    Candidate best = s.refine(x, mesh);
    for (std::size_t f = 0; f < s.faces.size(); ++f) {
      const auto face = static_cast<Index>(f);
      if (face == s.tessellation.mesh.faceOf[at(mesh.triangle)] || s.faceBoxes[f].isEmpty())
        continue;
      const double reach = best.distance + kReachFactor * s.slack[f] - kRoundOff * s.diagonal;
      if (!(reach > 0) || s.faceBoxes[f].squaredExteriorDistance(x) > reach * reach) continue;
      const FootPoint other = s.surface.footOnFace(x, face, reach);
      if (other.triangle == kNone) continue;
      const Candidate candidate = s.refine(x, other);
      if (candidate.distance < best.distance - kRoundOff * s.diagonal) best = candidate;
    }
    result.distance = best.distance;
    result.point = best.point;
    result.feature = best.feature;
    if (mesh.distance <= 2 * s.slack[at(best.face)] && !mesh.beyondBorder) {
      result.sign = s.signAt(x, best, mesh.sign);
    }
  } catch (...) {
    // OpenCASCADE gave up on this point: the triangles' distance stands.
    result.feature = s.surface.featureOf(mesh);
  }
  return result;
}

double TrueDistance::signedDistance(const Vec3& x) const {
  const Foot f = foot(x);
  return f.sign * f.distance;
}

const Tessellation& TrueDistance::tessellation() const { return impl_->tessellation; }
const SurfaceDistance& TrueDistance::surface() const { return impl_->surface; }

bool TrueDistance::pointAndNormal(Index triangle, const Vec3& barycentric, Vec3& point,
                                  Vec3& normal) const {
  const Impl& s = *impl_;
  const TriMesh& mesh = s.tessellation.mesh;
  if (triangle < 0 || at(triangle) >= mesh.triangles.size()) return false;
  const auto& corner = mesh.triangles[at(triangle)];
  const auto& t = s.tessellation.uv[at(triangle)];
  const Index face = mesh.faceOf[at(triangle)];
  const FaceSurface& surface = s.faces[at(face)]->surface();
  try {
    const auto uvAt = [&](const Vec3& b) -> Eigen::Vector2d {
      return b[0] * t[0] + b[1] * t[1] + b[2] * t[2];
    };
    Eigen::Vector2d uv = uvAt(barycentric);
    // Patches and triangles at apices have parameters that do not follow the triangle.
    const Vec3 x = barycentric[0] * mesh.points[at(corner[0])] +
                   barycentric[1] * mesh.points[at(corner[1])] +
                   barycentric[2] * mesh.points[at(corner[2])];
    const double near = kChordFactor * (s.faceFeature(face).deflection + kRoundOff * s.diagonal);
    if ((surface.point(uv) - x).norm() > near) {
      const SurfaceFoot better = surface.foot(x, kResidual * s.diagonal, uv);
      if (better.converged) uv = better.uv;
    }
    if (surface.pointAndNormal(uv, point, normal)) return true;
    uv += kNudge * (uvAt(Vec3::Constant(1.0 / 3.0)) - uv);
    return surface.pointAndNormal(uv, point, normal);
  } catch (...) {
    return false;
  }
}

TrueDistance::TrueDistance(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
TrueDistance::TrueDistance(TrueDistance&&) noexcept = default;
TrueDistance& TrueDistance::operator=(TrueDistance&&) noexcept = default;
TrueDistance::~TrueDistance() = default;

}  // namespace phront::cad
