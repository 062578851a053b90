// A hole drilled through a cylinder has a rim that is no circle. Where the hole is narrower than
// |d| the pipe round the rim folds over: beyond the ridge, where the pipes of the rim's two halves
// meet, each is nearer to the other half. A torus is cut off at its apex (spindle_pipe.cpp), these
// pipes at their ridge, which spares General Fuse an intersection that starts tangentially at both
// ends.
// Weak spot: rims from which a ridge with branches grows are left to General Fuse.
#include "patches/mouth_pipes.h"

#include <BRep_Builder.hxx>
#include <GeomAPI_Interpolate.hxx>
#include <Precision.hxx>
#include <TColStd_HArray1OfReal.hxx>
#include <TColgp_HArray1OfPnt.hxx>
#include <algorithm>
#include <cmath>

#include "patches/mouth_ridge.h"
#include "patches/mouth_strip.h"

namespace phront::cad {
namespace {

class Mouth {
 public:
  Mouth(const MouthStrips& one, const MouthStrips& other, const std::vector<RidgePiece>& ridge,
        ArcPool& arcs)
      : one_(one), other_(other), ridge_(ridge), arcs_(arcs) {
    vertices_.push_back(makeVertex(ridge.front().points.front().point, Precision::Confusion()));
    for (const RidgePiece& piece : ridge) {
      vertices_.push_back(makeVertex(piece.points.back().point, Precision::Confusion()));
      edges_.push_back(edgeOf(piece));
    }
  }

  std::vector<TopoDS_Face> faces() {
    std::vector<TopoDS_Face> faces;
    for (std::size_t i = 0; i < one_.size(); ++i) faces.push_back(face(one_[i], i, false));
    for (std::size_t j = 0; j < other_.size(); ++j) faces.push_back(face(other_[j], j, true));
    return faces;
  }

 private:
  /// Between the last two vertices, with s as its parameter.
  [[nodiscard]] TopoDS_Edge edgeOf(const RidgePiece& piece) const {
    const auto count = static_cast<int>(piece.points.size());
    const Handle(TColgp_HArray1OfPnt) points = new TColgp_HArray1OfPnt(1, count);
    const Handle(TColStd_HArray1OfReal) parameters = new TColStd_HArray1OfReal(1, count);
    for (int i = 1; i <= count; ++i) {
      points->SetValue(i, piece.points[static_cast<std::size_t>(i - 1)].point);
      parameters->SetValue(i, piece.points[static_cast<std::size_t>(i - 1)].s);
    }
    GeomAPI_Interpolate through(points, parameters, Standard_False, Precision::Confusion());
    through.Perform();
    const BRep_Builder builder;
    TopoDS_Edge edge;
    builder.MakeEdge(edge, through.Curve(), Precision::Confusion());
    builder.Add(edge, vertices_[vertices_.size() - 2].Oriented(TopAbs_FORWARD));
    builder.Add(edge, vertices_.back().Oriented(TopAbs_REVERSED));
    builder.Range(edge, piece.points.front().s, piece.points.back().s);
    return edge;
  }

  /// A piece of the ridge as a side of the strip number `k`.
  [[nodiscard]] PatchSide ridgeSide(std::size_t piece, const MouthStrip& strip, std::size_t k,
                                    bool isOther) const {
    std::vector<gp_Pnt2d> points;
    std::vector<double> parameters;
    for (const RidgePoint& p : ridge_[piece].points) {
      const double f = (isOther ? p.otherS : p.s) - static_cast<double>(k);
      points.emplace_back(isOther ? p.otherU : p.u, strip.parameter(std::clamp(f, 0.0, 1.0)));
      parameters.push_back(p.s);
    }
    return {
        edges_[piece], points.front(), points.back(), false, {}, pcurveThrough(points, parameters)};
  }

  /// At f = 0 or 1, from the ridge's vertex at u to the image that is kept.
  [[nodiscard]] PatchSide arcSide(const MouthStrip& strip, bool atLast, const TopoDS_Vertex& ridge,
                                  double u) const {
    const PipeFrame& frame = strip.frame();
    const bool edgeLast = atLast == strip.forward();
    const EdgeSample& s = edgeLast ? frame.info->samples.back() : frame.info->samples.front();
    const TopoDS_Vertex& image = strip.keepsImage2() ? (edgeLast ? frame.last2 : frame.first2)
                                                     : (edgeLast ? frame.last1 : frame.first1);
    const TopoDS_Edge arc = strip.keepsImage2()
                                ? arcs_.arc(s.point, s.axis(), frame.radius, ridge, image)
                                : arcs_.arc(s.point, s.axis(), frame.radius, image, ridge);
    return strip.sections().shortSide(strip.parameter(atLast ? 1 : 0), arc, ridge, u,
                                      strip.keepsImage2() ? 1 : 0);
  }

  [[nodiscard]] TopoDS_Face face(const MouthStrip& strip, std::size_t k, bool isOther) const {
    std::vector<PatchSide> ridgeSides;
    std::size_t first = ridge_.size();
    std::size_t last = 0;
    for (std::size_t piece = 0; piece < ridge_.size(); ++piece) {
      if ((isOther ? ridge_[piece].otherStrip : ridge_[piece].strip) != k) continue;
      first = std::min(first, piece);
      last = piece;
      ridgeSides.push_back(ridgeSide(piece, strip, k, isOther));
    }
    if (ridgeSides.empty()) throw Standard_Failure("a strip of a mouth has no ridge");
    const double kept = strip.keepsImage2() ? 1 : 0;
    const PipeFrame& frame = strip.frame();
    const double t0 = strip.sections().first();
    const double t1 = strip.sections().last();
    std::vector<PatchSide> sides{{strip.keepsImage2() ? frame.image2 : frame.image1,
                                  gp_Pnt2d(kept, t0),
                                  gp_Pnt2d(kept, t1),
                                  false,
                                  {}}};
    // The image runs from t0 to t1, so on to the arc at t1, back over the ridge, to the arc at t0.
    const PatchSide arcFirst =
        arcSide(strip, false, vertices_[first], ridgeSides.front().first.X());
    const PatchSide arcLast = arcSide(strip, true, vertices_[last + 1], ridgeSides.back().last.X());
    sides.push_back(strip.forward() ? arcLast : arcFirst);
    if (strip.forward()) std::reverse(ridgeSides.begin(), ridgeSides.end());
    sides.insert(sides.end(), ridgeSides.begin(), ridgeSides.end());
    sides.push_back(strip.forward() ? arcFirst : arcLast);
    return faceFromSides(strip.surface(), sides, Precision::Confusion());
  }

  const MouthStrips& one_;
  const MouthStrips& other_;
  const std::vector<RidgePiece>& ridge_;
  ArcPool& arcs_;
  std::vector<TopoDS_Vertex> vertices_;  ///< between the pieces of the ridge, and its tips
  std::vector<TopoDS_Edge> edges_;       ///< of the pieces
};

bool makeStrips(const std::vector<MouthEdge>& edges, MouthStrips& strips) {
  for (const MouthEdge& edge : edges) {
    if (!edge.frame.runsAlong()) return false;
    strips.emplace_back(edge);
  }
  return true;
}

bool prepare(MouthStrips& strips, const MouthStrips& others) {
  return std::all_of(strips.begin(), strips.end(),
                     [&](MouthStrip& strip) { return strip.prepare(others); });
}

}  // namespace

std::vector<TopoDS_Face> mouthPipes(const std::vector<MouthEdge>& one,
                                    const std::vector<MouthEdge>& other, ArcPool& arcs) {
  MouthStrips strips;
  MouthStrips others;
  if (!makeStrips(one, strips) || !makeStrips(other, others)) return {};
  if (!prepare(strips, others) || !prepare(others, strips)) return {};
  const std::optional<std::vector<RidgePiece>> ridge = followRidge(strips, others);
  if (!ridge) return {};
  return Mouth(strips, others, *ridge, arcs).faces();
}

}  // namespace phront::cad
