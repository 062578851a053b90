#include "surfaces/piece_trim.h"

#include <BOPTools_AlgoTools3D.hxx>
#include <BRepTools.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <IntTools_Context.hxx>
#include <Precision.hxx>
#include <algorithm>
#include <cmath>

#include "surfaces/loop_polygons.h"
#include "surfaces/slivers.h"

namespace phront::cad {
namespace {

constexpr double kMissedShare = 0.8;  // of the tolerance: nearer than |d| by this: not cut off
constexpr double kClearShare = 0.1;   // nearer by less: certainly on the front
constexpr std::size_t kLeastClear = 6;
constexpr int kLeastGrid = 16;
constexpr int kMostGrid = 64;
constexpr double kMargin = 0.01;  // of the domain: how far cuts at the box run beyond it
constexpr int kLooks = 40;        // per direction, into a part that was cut out
constexpr int kMostRounds = 4;
constexpr int kLeastCells = 96;  // per direction, where lines cannot be followed
constexpr int kMostCells = 384;
constexpr int kMeasured = 14;  // per direction, of each trimmed surface

/// One piece of the offset of a face, its clearance and where that is negative.
class PieceTrimmer {
 public:
  PieceTrimmer(const TopoDS_Face& face, const OffsetPiece& piece, const TrimRequest& request,
               const TrueDistance& phi)
      : face_(face),
        piece_(piece),
        request_(request),
        front_(face, piece.surface, piece.box, request, phi) {}

  /// Faces on the piece's surface, FORWARD. `cutAtBox`: the face reaches beyond the piece.
  Result<std::vector<TopoDS_Face>> trimmed(bool cutAtBox, bool& whole) {
    front_.sampleInside(kLeastGrid);
    front_.sampleLoops();
    if (front_.validSamples() == 0) front_.sampleInside(kMostGrid);  // before it is said to be gone
    std::vector<TopoDS_Face> faces;
    if (front_.validSamples() == 0) return faces;
    const Result<TopoDS_Face> domain = front_.plane().domainOf(face_);
    if (!domain) return tl::unexpected(domain.error());
    std::vector<TopoDS_Face> kept;
    std::vector<Contour> lines;
    int cells = 0;  // none while lines are followed
    for (int round = 0; cells < kMostCells; ++round) {
      const std::size_t before = lines.size();
      if (cells == 0) front_.traceLines(lines);
      // Where nothing is gained by following lines, the measure is at odds with itself or they are
      // too many: cells do, and smaller ones where those see too little.
      if (cells > 0 || (round > 0 && lines.size() == before) || round + 1 == kMostRounds) {
        cells = std::max(kLeastCells, 2 * cells);
        lines = front_.gridLines(cells);
      }
      std::vector<TopoDS_Edge> edges = ParameterPlane::edgesAlong(lines, front_.chord());
      if (cutAtBox) addBox(edges);
      const Result<std::vector<TopoDS_Face>> parts = ParameterPlane::split(*domain, edges);
      if (!parts) return tl::unexpected(parts.error());
      kept.clear();
      front_.seeds().clear();
      for (const TopoDS_Face& part : *parts)
        if (alive(part)) kept.push_back(part);
      if (front_.seeds().empty()) break;
    }
    whole = lines.empty() && !cutAtBox;
    // Parts and holes narrower than the tolerance: the distance changes by less from their middle
    // to their borders, and OpenCASCADE can do little with them.
    const double sliver = request_.tolerance;
    for (const TopoDS_Face& part : kept) {
      const Result<TopoDS_Face> face =
          front_.plane().onSurface(withoutSlits(part, sliver), piece_.surface, front_.chord());
      if (!face) return tl::unexpected(face.error());
      if (meanWidth(*face) >= sliver) faces.push_back(*face);
    }
    return faces;
  }

  /// Largest | |phi| - |d| | of samples of a trimmed face.
  [[nodiscard]] double deviation(const TopoDS_Face& face) const {
    const BRepTopAdaptor_FClass2d inside(face, Precision::PConfusion());
    double u0 = 0;
    double u1 = 0;
    double v0 = 0;
    double v1 = 0;
    BRepTools::UVBounds(face, u0, u1, v0, v1);
    const Vec2 low = front_.plane().toPlane({u0, v0});
    const Vec2 high = front_.plane().toPlane({u1, v1});
    double most = 0;
    for (const double x : front_.middles(0, {low[0], high[0]}, kMeasured)) {
      for (const double y : front_.middles(1, {low[1], high[1]}, kMeasured)) {
        const Vec2 uv = front_.plane().fromPlane({x, y});
        if (inside.Perform(gp_Pnt2d(uv[0], uv[1])) != TopAbs_IN) continue;
        most = std::max(most, std::abs(front_.level({x, y}) - std::abs(request_.distance)));
      }
    }
    return most;
  }

 private:
  void addBox(std::vector<TopoDS_Edge>& edges) const {
    const Vec2 margin = kMargin * (front_.high() - front_.low());
    const ParameterBox& b = piece_.box;
    const Vec2 extra = front_.plane().fromPlane(margin);
    for (const double u : {b.u.low, b.u.high})
      edges.push_back(
          front_.plane().edgeBetween({u, b.v.low - extra[1]}, {u, b.v.high + extra[1]}));
    for (const double v : {b.v.low, b.v.high})
      edges.push_back(
          front_.plane().edgeBetween({b.u.low - extra[0], v}, {b.u.high + extra[0], v}));
  }

  /// Whether most points inside a part of the domain are valid, and in this piece. Those that
  /// clearly are otherwise give seeds for more lines.
  [[nodiscard]] bool alive(const TopoDS_Face& part) {
    std::vector<Vec2> clear;   // certainly valid
    std::vector<Vec2> missed;  // certainly not
    int good = 0;
    int bad = 0;
    const auto look = [&](const Vec2& x) {
      if (!front_.inBox(x)) {
        ++bad;
        return;
      }
      const double lack = std::abs(request_.distance) - front_.level(x);
      (lack <= front_.cut() ? good : bad) += 1;
      if (lack <= kClearShare * request_.tolerance) clear.push_back(x);
      if (lack > kMissedShare * request_.tolerance) missed.push_back(x);
    };
    const Handle(IntTools_Context) context = new IntTools_Context;
    gp_Pnt p;
    gp_Pnt2d uv;
    if (BOPTools_AlgoTools3D::PointInFace(part, p, uv, context) == 0) look({p.X(), p.Y()});
    double u0 = 0;
    double u1 = 0;
    double v0 = 0;
    double v1 = 0;
    BRepTools::UVBounds(part, u0, u1, v0, v1);
    const LoopPolygons inside(part, front_.chord());
    for (const double x : front_.middles(0, {u0, u1}, front_.cellsFor(u1 - u0, kLooks))) {
      for (const double y : front_.middles(1, {v0, v1}, front_.cellsFor(v1 - v0, kLooks)))
        if (inside.contains({x, y})) look({x, y});
    }
    const bool kept = good > bad;
    // Few valid points of a part that goes lie beside its border.
    if (kept || clear.size() >= kLeastClear) seedBetween(clear, missed);
    return kept;
  }

  void seedBetween(const std::vector<Vec2>& with, const std::vector<Vec2>& without) {
    const bool fewerWith = with.size() < without.size();
    const std::vector<Vec2>& few = fewerWith ? with : without;
    const std::vector<Vec2>& many = fewerWith ? without : with;
    for (const Vec2& x : few) {
      const auto nearest =
          std::min_element(many.begin(), many.end(), [&](const Vec2& a, const Vec2& b) {
            return (a - x).squaredNorm() < (b - x).squaredNorm();
          });
      front_.seeds().push_back(fewerWith ? ContourSeed{*nearest, x} : ContourSeed{x, *nearest});
    }
  }

  TopoDS_Face face_;
  const OffsetPiece& piece_;
  const TrimRequest& request_;
  PieceFront front_;
};

}  // namespace

Result<TrimmedPiece> trimPiece(const TopoDS_Face& face, const OffsetPiece& piece, bool cutAtBox,
                               const TrimRequest& request, const TrueDistance& phi) {
  PieceTrimmer trimmer(face, piece, request, phi);
  TrimmedPiece result;
  Result<std::vector<TopoDS_Face>> faces = trimmer.trimmed(cutAtBox, result.whole);
  if (!faces) return tl::unexpected(faces.error());
  result.faces = std::move(*faces);
  for (const TopoDS_Face& trimmed : result.faces)
    result.deviation = std::max(result.deviation, trimmer.deviation(trimmed));
  return result;
}

}  // namespace phront::cad
