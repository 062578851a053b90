// A crossing that General Fuse misses leaves a hole a small part of |d| across, and a vertex with
// an unusual set of edges one of the size of |d|. The rest of the solid is exact; small flat holes
// get a plane, others a thin-plate surface through the edges around the hole and points of phi = d
// inside it stands in for what is missing (Duchon 1977; OpenCASCADE's N-sided filling). The check
// of the whole says whether it is good enough. Weak spot: a hole with more than one loop of open
// edges gets a patch for each of them.
#include "rebuild/fill_gaps.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepBndLib.hxx>
#include <BRepFill_Filling.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Geom_Plane.hxx>
#include <Precision.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "exchange/tolerances.h"
#include "patches/patch_tools.h"
#include "rebuild/edge_uses.h"

namespace phront::cad {
namespace {

// More open edges than this are no gaps: something is wrong with the whole.
constexpr std::size_t kMostOpenEdges = 160;
// Edges of a gap may lie this part of |d| off the level: what the check allows single points.
constexpr double kOffLevel = 0.08;
// Gaps with less than this reach are closed by a plane if they are as flat as that, of |d|.
constexpr double kSmall = 0.3;
constexpr double kFlatness = 0.05;
// The box of a patch around poles, in reaches of its gap: beyond it the patch has swung out.
constexpr double kLargestBox = 8;
// Slits up to this width, of |d|, are sewn; to this multiple of their width.
constexpr double kThinSlit = 0.01;
constexpr double kSlitSewing = 1.5;
constexpr int kEdgePoints = 5;
constexpr int kProjectionSteps = 6;
// Points inside the gap: this part of the way from its middle to points of its edges.
constexpr double kInside = 0.5;

Vec3 toVec(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }

using Loop = std::vector<TopoDS_Edge>;  // oriented along the loop

std::vector<TopoDS_Edge> openEdges(const std::vector<TopoDS_Face>& faces) {
  const EdgeUses uses(faces);
  std::vector<TopoDS_Edge> open;
  for (std::size_t e = 0; e < uses.faces.size(); ++e)
    if (uses.faces[e].size() == 1) open.push_back(uses.edge(e));
  return open;
}

/// Closed chains of the edges; where more than two meet, the first that closes.
std::vector<Loop> loopsOf(const std::vector<TopoDS_Edge>& edges, int& left) {
  std::map<const void*, std::vector<std::size_t>> at;
  const auto ends = [](const TopoDS_Edge& edge) {
    return std::pair<const void*, const void*>(TopExp::FirstVertex(edge).TShape().get(),
                                               TopExp::LastVertex(edge).TShape().get());
  };
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto [first, last] = ends(edges[i]);
    at[first].push_back(i);
    if (last != first) at[last].push_back(i);
  }
  std::vector<char> used(edges.size(), 0);
  std::vector<Loop> loops;
  for (std::size_t seed = 0; seed < edges.size(); ++seed) {
    if (used[seed]) continue;
    used[seed] = 1;
    Loop loop{TopoDS::Edge(edges[seed].Oriented(TopAbs_FORWARD))};
    const auto [start, seedEnd] = ends(edges[seed]);
    const void* here = seedEnd;
    while (here != start) {
      const auto& around = at[here];
      const auto next =
          std::find_if(around.begin(), around.end(), [&](std::size_t i) { return !used[i]; });
      if (next == around.end()) break;
      used[*next] = 1;
      const auto [first, last] = ends(edges[*next]);
      const bool forward = first == here;
      loop.push_back(
          TopoDS::Edge(edges[*next].Oriented(forward ? TopAbs_FORWARD : TopAbs_REVERSED)));
      here = forward ? last : first;
    }
    if (here == start)
      loops.push_back(std::move(loop));
    else
      left += 1;
  }
  return loops;
}

std::vector<Vec3> pointsAlong(const Loop& loop) {
  std::vector<Vec3> points;
  for (const TopoDS_Edge& edge : loop) {
    const BRepAdaptor_Curve curve(edge);
    for (int i = 0; i < kEdgePoints; ++i) {
      const double along = (i + 0.5) / kEdgePoints;
      const double share = edge.Orientation() == TopAbs_REVERSED ? 1 - along : along;
      points.push_back(toVec(curve.Value(
          curve.FirstParameter() + share * (curve.LastParameter() - curve.FirstParameter()))));
    }
  }
  return points;
}

/// Largest distance of the two sides of a slit; infinite for loops of more than two edges.
double slitWidth(const Loop& loop) {
  if (loop.size() != 2) return std::numeric_limits<double>::infinity();
  constexpr int kPoints = 33;
  std::array<std::vector<Vec3>, 2> sides;
  for (std::size_t k = 0; k < 2; ++k) {
    const BRepAdaptor_Curve curve(loop[k]);
    for (int i = 0; i < kPoints; ++i) {
      sides[k].push_back(
          toVec(curve.Value(curve.FirstParameter() +
                            (curve.LastParameter() - curve.FirstParameter()) * i / (kPoints - 1))));
    }
  }
  double width = 0;
  for (const Vec3& p : sides[0]) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec3& q : sides[1]) nearest = std::min(nearest, (p - q).norm());
    width = std::max(width, nearest);
  }
  return width;
}

/// The plane of a flat loop, which keeps the edges as they are; null when it is not flat.
TopoDS_Face planarPatch(const Loop& loop, const std::vector<Vec3>& border, const Vec3& middle,
                        double flatness) {
  Vec3 normal = Vec3::Zero();  // twice the area: the loop runs counter-clockwise around it
  for (std::size_t i = 0; i < border.size(); ++i) {
    normal += (border[i] - middle).cross(border[(i + 1) % border.size()] - middle);
  }
  if (!(normal.norm() > 0)) return {};
  normal.normalize();
  for (const Vec3& p : border) {
    if (std::abs(normal.dot(p - middle)) > flatness) return {};
  }
  const gp_Pnt origin(middle.x(), middle.y(), middle.z());
  const gp_Dir axis(normal.x(), normal.y(), normal.z());
  const BRep_Builder builder;
  TopoDS_Face face;
  builder.MakeFace(face, new Geom_Plane(origin, axis), Precision::Confusion());
  TopoDS_Wire wire;
  builder.MakeWire(wire);
  for (const TopoDS_Edge& edge : loop) builder.Add(wire, edge);
  wire.Closed(Standard_True);
  builder.Add(face, wire);
  settleTolerances({face});
  return face;
}

/// The point of the level next to x, along the gradient.
std::optional<Vec3> onLevel(Vec3 x, const GapOptions& options, const TrueDistance& phi) {
  for (int step = 0; step < kProjectionSteps; ++step) {
    const TrueDistance::Foot foot = phi.foot(x);
    if (!(foot.distance > 0)) return std::nullopt;
    const double off = options.distance - foot.sign * foot.distance;
    if (std::abs(off) <= options.tolerance) return x;
    x += off * foot.sign * (x - foot.point) / foot.distance;
  }
  return std::nullopt;
}

std::optional<TopoDS_Face> patchFor(const Loop& loop, const GapOptions& options,
                                    const TrueDistance& phi) {
  const std::vector<Vec3> border = pointsAlong(loop);
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : border) {
    if (std::abs(phi.signedDistance(p) - options.distance) >
        kOffLevel * std::abs(options.distance)) {
      return std::nullopt;
    }
    middle += p / static_cast<double>(border.size());
  }
  double size = 0;
  for (const Vec3& p : border) size = std::max(size, (p - middle).norm());
  if (size < kSmall * std::abs(options.distance)) {
    const TopoDS_Face flat =
        planarPatch(loop, border, middle, kFlatness * std::abs(options.distance));
    if (!flat.IsNull()) return flat;
  }

  constexpr int kDegree = 3;
  constexpr int kCurvePoints = 15;
  constexpr int kIterations = 2;
  BRepFill_Filling filling(kDegree, kCurvePoints, kIterations, Standard_False, 1e-5,
                           options.tolerance);
  for (const TopoDS_Edge& edge : loop) filling.Add(edge, GeomAbs_C0);
  if (loop.size() > 2) {
    if (const auto centre = onLevel(middle, options, phi)) {
      filling.Add(gp_Pnt(centre->x(), centre->y(), centre->z()));
    }
    for (std::size_t i = kEdgePoints / 2; i < border.size(); i += kEdgePoints) {
      const auto inside = onLevel(middle + kInside * (border[i] - middle), options, phi);
      if (inside) filling.Add(gp_Pnt(inside->x(), inside->y(), inside->z()));
    }
  }
  filling.Build();
  if (!filling.IsDone()) return std::nullopt;
  const TopoDS_Face face = filling.Face();
  // Thin plates through ill-placed points swing out.
  Bnd_Box box;
  BRepBndLib::Add(face, box, Standard_False);
  if (box.IsVoid() || std::sqrt(box.SquareExtent()) > kLargestBox * size) return std::nullopt;
  return face;
}

}  // namespace

FilledGaps fillGaps(const std::vector<TopoDS_Face>& faces, const GapOptions& options,
                    const TrueDistance& phi) {
  FilledGaps result;
  const std::vector<TopoDS_Edge> open = openEdges(faces);
  if (open.size() > kMostOpenEdges) {
    result.unfilled = static_cast<int>(open.size());
    return result;
  }
  for (const Loop& loop : loopsOf(open, result.unfilled)) {
    const double slit = slitWidth(loop);
    if (slit <= kThinSlit * std::abs(options.distance)) {
      result.sewing = std::max(result.sewing, kSlitSewing * slit);
      continue;
    }
    std::optional<TopoDS_Face> patch;
    try {
      patch = patchFor(loop, options, phi);
    } catch (const Standard_Failure&) {
      patch.reset();
    }
    if (patch)
      result.patches.push_back(*patch);
    else
      ++result.unfilled;
  }
  return result;
}

}  // namespace phront::cad
