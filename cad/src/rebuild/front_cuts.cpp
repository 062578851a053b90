// A crossing that General Fuse misses (nearly tangent pipes, a patch that crosses itself) leaves a
// piece of which one part is on the offset and another is not. The line between is where a second
// part of the shape comes as near as |d|: phi alone shows it, whichever patch it is that crosses.
#include "rebuild/front_cuts.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Standard_Failure.hxx>
#include <algorithm>
#include <cmath>

#include "surfaces/piece_front.h"

namespace phront::cad {
namespace {

constexpr double kTolerance = 8e-4;  // of |d|, at which lines are followed before they are moved
constexpr double kNoiseShare = 2.5;  // times the noise of the pieces: at least
constexpr double kNear = 0.05;       // of |d|: pieces this near to an open edge are looked at
constexpr int kSamples = 16;         // per direction
constexpr double kPitch = 1;         // |d|, between points that are looked at first
constexpr double kAstray = 0.01;     // of |d|
constexpr double kMeshSlack = 4;     // times the deflection
constexpr double kCurveShare = 0.2;  // of the chord: the curves in space
constexpr double kMostShift = 20;    // cuts
constexpr double kBeside = 4;        // chords: lines nearer to the border are none

/// Lines are followed where the shape is nearer by `cut`, as phi has a slope there only: from there
/// to where it is as near as |d|.
void moveToLevel(const PieceFront& front, Contour& line) {
  for (Vec2& x : line.points) {
    const Clearance here = front.clearance(x);
    const double square = here.gradient.squaredNorm();
    if (!(here.value < 0) || !(square > 0)) continue;
    const Vec2 shift = ((front.cut() - here.value) / square) * here.gradient;
    if (shift.norm() <= kMostShift * front.cut()) x += shift;
  }
}

/// What of a line runs through the face, not along its border, and a point more at each end: pieces
/// end where the front does, which is no cut.
std::vector<Contour> throughFace(PieceFront& front, const Contour& line) {
  std::vector<Vec2> points = line.points;
  if (line.closed) points.push_back(points.front());
  std::vector<char> through;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 along = points[std::min(i + 1, points.size() - 1)] - points[i > 0 ? i - 1 : 0];
    const Vec2 aside = kBeside * front.chord() * Vec2(-along[1], along[0]).normalized();
    through.push_back(front.inFace(points[i] + aside) && front.inFace(points[i] - aside));
  }
  if (std::all_of(through.begin(), through.end(), [](char t) { return t != 0; })) return {line};
  std::vector<Contour> parts;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!through[i]) continue;
    if (i == 0 || !through[i - 1]) {
      parts.emplace_back();
      if (i > 0) parts.back().points.push_back(points[i - 1]);
    }
    parts.back().points.push_back(points[i]);
    if (i + 1 < points.size() && !through[i + 1]) parts.back().points.push_back(points[i + 1]);
  }
  return parts;
}

std::vector<TopoDS_Edge> cutsOf(const TopoDS_Face& piece, const TrimRequest& request,
                                const TrueDistance& phi) {
  ParameterBox box;
  BRepTools::UVBounds(piece, box.u.low, box.u.high, box.v.low, box.v.high);
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(piece);
  PieceFront front(piece, surface, box, request, phi);
  front.sampleInside(kSamples, false);
  front.sampleLoops();
  if (front.validSamples() == 0 || front.seeds().empty()) return {};
  std::vector<Contour> whole;
  front.traceLines(whole);
  std::vector<Contour> lines;
  for (Contour& line : whole) {
    moveToLevel(front, line);
    const std::vector<Contour> parts = throughFace(front, line);
    lines.insert(lines.end(), parts.begin(), parts.end());
  }
  std::vector<TopoDS_Edge> edges = front.plane().onSurface(
      ParameterPlane::edgesAlong(lines, front.chord()), surface, kCurveShare * front.chord());
  const BRep_Builder builder;
  for (const TopoDS_Edge& edge : edges) builder.UpdateEdge(edge, front.chord());
  return edges;
}

/// Whether some point inside is clearly nearer to the shape than |d|, by triangles alone.
bool astray(const TopoDS_Face& piece, double distance, const TrueDistance& phi) {
  const BRepAdaptor_Surface surface(piece, Standard_False);
  const double least =
      (1 - kAstray) * std::abs(distance) - kMeshSlack * phi.tessellation().measuredDeflection;
  const std::vector<gp_Pnt2d> grid = gridInside(piece, kPitch * std::abs(distance));
  return std::any_of(grid.begin(), grid.end(), [&](const gp_Pnt2d& uv) {
    const gp_Pnt p = surface.Value(uv.X(), uv.Y());
    return phi.surface().foot({p.X(), p.Y(), p.Z()}).distance < least;
  });
}

}  // namespace

std::vector<TopoDS_Shape> frontCuts(const std::vector<JudgedFace>& pieces, bool solid,
                                    double distance, double noise, const TrueDistance& phi) {
  std::vector<Bnd_Box> open;
  for (const TopoDS_Edge& edge : openEdges(pieces)) {
    Bnd_Box box;
    BRepBndLib::Add(edge, box, Standard_False);
    box.Enlarge(kNear * std::abs(distance));
    open.push_back(box);
  }
  const TrimRequest request{solid, distance,
                            std::max(kTolerance * std::abs(distance), kNoiseShare * noise)};
  std::vector<TopoDS_Shape> cuts;
  for (const JudgedFace& piece : pieces) {
    Bnd_Box box;
    BRepBndLib::Add(piece.face, box, Standard_False);
    const bool nearOpen =
        std::any_of(open.begin(), open.end(), [&](const Bnd_Box& b) { return !b.IsOut(box); });
    try {
      if (!nearOpen && !(piece.live && astray(piece.face, distance, phi))) continue;
      const std::vector<TopoDS_Edge> more = cutsOf(piece.face, request, phi);
      cuts.insert(cuts.end(), more.begin(), more.end());
    } catch (const Standard_Failure&) {
      continue;  // it stays whole
    }
  }
  return cuts;
}

}  // namespace phront::cad
