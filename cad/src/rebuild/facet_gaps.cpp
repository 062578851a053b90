// What exact patches leave open is little: one crossing that nothing finds spoils one corner of a
// solid. That corner is given up, not the solid. Edges of the pieces around a hole are divided
// until they are nearly straight and serve as sides of the facets, so nothing has to be sewn. Weak
// spot: a hole with several loops is known only where pieces were taken away.
#include "rebuild/facet_gaps.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom_Line.hxx>
#include <Geom_Plane.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "exchange/measures.h"
#include "exchange/tolerances.h"
#include "phront/fill_hole.h"
#include "rebuild/edge_uses.h"
#include "rebuild/fuse.h"
#include "rebuild/piece_faults.h"
#include "rebuild/select.h"

namespace phront::cad {
namespace {

constexpr double kMostRemoved = 0.4;             // of the area
constexpr std::array kChords{6e-3, 2e-3, 5e-4};  // of |d|, of the edges around holes: tried in turn
constexpr double kLongestSide = 10;              // of |d|
constexpr int kMostDivisions = 8;                // of an edge, by halving
constexpr double kStep = 1e-3;                   // of |d|, to see which way phi grows
constexpr int kProjectionSteps = 24;             // at a crease it goes from side to side
constexpr double kOnLevel = 1e-4;                // of |d|
constexpr double kSamePlace = 1e-5;              // of |d|
constexpr Index kMostFacets = 1500;              // of one hole

using Loop = std::vector<TopoDS_Edge>;  // oriented along the loop, the hole on the left

Vec3 toVec(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }
gp_Pnt toPnt(const Vec3& p) { return {p[0], p[1], p[2]}; }

class GapFaceter {
 public:
  GapFaceter(std::vector<TopoDS_Face> pieces, const FacetGapOptions& options,
             const TrueDistance& phi)
      : pieces_(std::move(pieces)), options_(options), phi_(phi) {}

  std::optional<FacetedGaps> run() {
    double area = 0;
    for (const TopoDS_Face& piece : pieces_) area += areaOf(piece);
    std::optional<SortedPieces> sorted =
        removeFaultyPieces(std::move(pieces_), options_.distance, phi_);
    if (!sorted) return std::nullopt;
    pieces_ = std::move(sorted->kept);
    removed_ = std::move(sorted->removed);
    double gone = 0;
    for (const TopoDS_Face& piece : removed_) gone += areaOf(piece);
    if (gone > kMostRemoved * area || pieces_.empty()) return std::nullopt;
    const std::vector<TopoDS_Face> whole = pieces_;
    for (const double chord : kChords) {
      pieces_ = whole;
      std::optional<FacetedGaps> result = filled(chord * size());
      if (result && valid(*result)) return result;
    }
    return std::nullopt;
  }

 private:
  std::optional<FacetedGaps> filled(double chord) {
    if (!divideOpenEdges(chord)) return std::nullopt;
    std::optional<std::vector<Loop>> loops = openLoops();
    if (!loops || loops->empty()) return std::nullopt;
    FacetedGaps result;
    for (const std::vector<Loop>& hole : holesOf(std::move(*loops))) {
      if (!fill(hole, result)) return std::nullopt;
    }
    result.facets = static_cast<int>(result.faces.size());
    result.faces.insert(result.faces.begin(), pieces_.begin(), pieces_.end());
    settleTolerances(result.faces);
    return result;
  }

  /// A narrow triangle next to an edge that is not straight enough may be crossed by it.
  static bool valid(const FacetedGaps& result) {
    return std::all_of(result.faces.end() - result.facets, result.faces.end(),
                       [](const TopoDS_Face& face) { return BRepCheck_Analyzer(face).IsValid(); });
  }

  [[nodiscard]] double size() const { return std::abs(options_.distance); }
  /// Parameters that divide an edge into nearly straight parts, at least two.
  [[nodiscard]] std::vector<double> divisions(const TopoDS_Edge& edge, double chord) const {
    const BRepAdaptor_Curve curve(edge);
    std::vector<double> found;
    const auto halve = [&](const auto& self, double a, double b, int depth) -> void {
      const double m = (a + b) / 2;
      const gp_Pnt pa = curve.Value(a);
      const gp_Pnt pb = curve.Value(b);
      double off = 0;
      for (const double t : {(a + m) / 2, m, (m + b) / 2}) {
        const gp_Pnt p = curve.Value(t);
        const gp_Vec along(pa, pb);
        const gp_Vec arm(pa, p);
        const double length = along.Magnitude();
        off = std::max(off, length > 0 ? along.Crossed(arm).Magnitude() / length : arm.Magnitude());
      }
      const bool enough = off <= chord && pa.Distance(pb) <= kLongestSide * size();
      if (depth >= kMostDivisions || (depth > 0 && enough)) return;
      self(self, a, m, depth + 1);
      found.push_back(m);
      self(self, m, b, depth + 1);
    };
    halve(halve, curve.FirstParameter(), curve.LastParameter(), 0);
    return found;
  }

  bool divideOpenEdges(double chord) {
    const EdgeUses uses(pieces_);
    std::vector<TopoDS_Shape> points;
    for (std::size_t e = 0; e < uses.faces.size(); ++e) {
      if (uses.faces[e].size() != 1) continue;
      const BRepAdaptor_Curve curve(uses.edge(e));
      for (const double t : divisions(uses.edge(e), chord))
        points.push_back(makeVertex(curve.Value(t), Precision::Confusion()));
    }
    const auto never = [](std::size_t, std::size_t) { return false; };
    Result<std::vector<TopoDS_Face>> divided = splitFaces(pieces_, 0, never, points);
    if (!divided) return false;
    pieces_ = std::move(*divided);
    return true;
  }

  /// Simple loops of edges that one piece uses; empty when they do not close.
  [[nodiscard]] std::optional<std::vector<Loop>> openLoops() const {
    const EdgeUses uses(pieces_);
    TopTools_IndexedMapOfShape vertices;
    std::map<int, std::vector<TopoDS_Edge>> from;  // directed edges by first vertex
    std::size_t left = 0;
    for (std::size_t e = 0; e < uses.faces.size(); ++e) {
      if (uses.faces[e].size() != 1) continue;
      const TopoDS_Face& piece = pieces_[uses.faces[e][0]];
      const std::vector<FaceSample> samples = interiorSamples(piece);
      if (samples.empty()) return std::nullopt;
      const bool outward =
          facesOutward(samples.front(), samples.front().normal, kStep * size(), phi_);
      // As the piece uses it the piece is on the left, seen from where its normal points.
      const bool forward = (uses.edge(e).Orientation() == TopAbs_FORWARD) == outward;
      const TopoDS_Edge along =
          TopoDS::Edge(uses.edge(e).Oriented(forward ? TopAbs_REVERSED : TopAbs_FORWARD));
      from[vertices.Add(TopExp::FirstVertex(along, Standard_True))].push_back(along);
      ++left;
    }
    std::vector<Loop> loops;
    while (left > 0) {
      const auto start = std::find_if(from.begin(), from.end(),
                                      [](const auto& entry) { return !entry.second.empty(); });
      Loop path;
      std::vector<int> at{start->first};
      while (!at.empty()) {
        std::vector<TopoDS_Edge>& next = from[at.back()];
        if (next.empty()) {
          if (path.empty()) break;
          return std::nullopt;
        }
        path.push_back(next.back());
        next.pop_back();
        --left;
        const int to = vertices.FindIndex(TopExp::LastVertex(path.back(), Standard_True));
        const auto seen = std::find(at.begin(), at.end(), to);
        if (seen == at.end()) {
          at.push_back(to);
          continue;
        }
        const auto first = static_cast<std::ptrdiff_t>(seen - at.begin());
        loops.emplace_back(path.begin() + first, path.end());
        path.erase(path.begin() + first, path.end());
        at.erase(at.begin() + first + 1, at.end());
        if (path.empty()) break;
      }
    }
    return loops;
  }

  /// Loops around the same connected set of pieces that were taken away bound one hole.
  [[nodiscard]] std::vector<std::vector<Loop>> holesOf(std::vector<Loop> loops) const {
    std::vector<std::size_t> parent(removed_.size());
    for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = i;
    const auto root = [&](std::size_t i) {
      while (parent[i] != i) i = parent[i];
      return i;
    };
    const EdgeUses uses(removed_);
    for (const std::vector<std::size_t>& users : uses.faces)
      for (const std::size_t f : users) parent[root(f)] = root(users.front());
    std::map<std::size_t, std::vector<Loop>> around;
    std::vector<std::vector<Loop>> holes;
    for (Loop& loop : loops) {
      std::optional<std::size_t> component;
      const gp_Pnt p = BRep_Tool::Pnt(TopExp::FirstVertex(loop.front()));
      const gp_Pnt q = BRep_Tool::Pnt(TopExp::LastVertex(loop.front()));
      for (std::size_t e = 0; e < uses.faces.size() && !component; ++e) {
        const BRepAdaptor_Curve curve(uses.edge(e));
        const auto onIt = [&](const gp_Pnt& x) { return isOn(curve, x); };
        if (onIt(p) && onIt(q)) component = root(uses.faces[e].front());
      }
      if (component)
        around[*component].push_back(std::move(loop));
      else
        holes.push_back({std::move(loop)});
    }
    for (auto& [component, its] : around) holes.push_back(std::move(its));
    return holes;
  }
  [[nodiscard]] bool isOn(const BRepAdaptor_Curve& curve, const gp_Pnt& x) const {
    // Division points are halves of the edge's parameters.
    constexpr int kParts = 1 << kMostDivisions;
    for (int i = 0; i <= kParts; ++i) {
      const double t =
          curve.FirstParameter() + (curve.LastParameter() - curve.FirstParameter()) * i / kParts;
      if (curve.Value(t).Distance(x) <= kSamePlace * size()) return true;
    }
    return false;
  }

  /// The point of the level next to x, along the gradient.
  [[nodiscard]] std::optional<Vec3> onLevel(const Vec3& start) const {
    Vec3 x = start;
    for (int step = 0; step < kProjectionSteps; ++step) {
      const TrueDistance::Foot foot = phi_.foot(x);
      if (!(foot.distance > 0)) return std::nullopt;
      const double off = options_.distance - foot.sign * foot.distance;
      if (std::abs(off) <= kOnLevel * size()) return x;
      x += off * foot.sign * (x - foot.point) / foot.distance;
      if ((x - start).norm() > size()) return std::nullopt;
    }
    return std::nullopt;
  }

  bool fill(const std::vector<Loop>& hole, FacetedGaps& result) const {
    std::vector<std::vector<Vec3>> corners;
    std::vector<TopoDS_Vertex> vertices;
    std::map<std::pair<Index, Index>, TopoDS_Edge> edges;  // by smaller and larger corner
    for (const Loop& loop : hole) {
      const auto first = static_cast<Index>(vertices.size());
      const auto count = static_cast<Index>(loop.size());
      corners.emplace_back();
      for (Index k = 0; k < count; ++k) {
        const TopoDS_Edge& edge = loop[static_cast<std::size_t>(k)];
        vertices.push_back(TopExp::FirstVertex(edge, Standard_True));
        corners.back().push_back(toVec(BRep_Tool::Pnt(vertices.back())));
        const Index a = first + k;
        const Index b = first + (k + 1) % count;
        edges[{std::min(a, b), std::max(a, b)}] = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
      }
    }
    const ToSurface toLevel = [this](const Vec3& x) { return onLevel(x); };
    const Result<HoleFill> patch =
        fillHole(corners, toLevel, {options_.tolerance, kLongestSide * size(), kMostFacets});
    if (!patch) return false;
    const BRep_Builder builder;
    for (std::size_t p = vertices.size(); p < patch->points.size(); ++p)
      vertices.push_back(makeVertex(toPnt(patch->points[p]), Precision::Confusion()));
    const auto edgeBetween = [&](Index a, Index b) {
      TopoDS_Edge& edge = edges[{std::min(a, b), std::max(a, b)}];
      if (!edge.IsNull()) return edge;
      const TopoDS_Vertex& from = vertices[static_cast<std::size_t>(a)];
      const TopoDS_Vertex& to = vertices[static_cast<std::size_t>(b)];
      const gp_Pnt pa = BRep_Tool::Pnt(from);
      const gp_Pnt pb = BRep_Tool::Pnt(to);
      builder.MakeEdge(edge, new Geom_Line(pa, gp_Dir(gp_Vec(pa, pb))), Precision::Confusion());
      builder.Add(edge, from.Oriented(TopAbs_FORWARD));
      builder.Add(edge, to.Oriented(TopAbs_REVERSED));
      builder.Range(edge, 0, pa.Distance(pb));
      return edge;
    };
    for (const std::array<Index, 3>& t : patch->triangles) {
      const auto at = [&](std::size_t k) { return patch->points[static_cast<std::size_t>(t[k])]; };
      const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0));
      if (!(normal.norm() > 0)) return false;
      TopoDS_Face face;
      builder.MakeFace(face,
                       new Geom_Plane(toPnt((at(0) + at(1) + at(2)) / 3),
                                      gp_Dir(normal[0], normal[1], normal[2])),
                       Precision::Confusion());
      TopoDS_Wire wire;
      builder.MakeWire(wire);
      for (std::size_t k = 0; k < 3; ++k) {
        const Index a = t[k];
        const TopoDS_Edge edge = edgeBetween(a, t[(k + 1) % 3]);
        const bool forward =
            TopExp::FirstVertex(edge).IsSame(vertices[static_cast<std::size_t>(a)]);
        builder.Add(wire, edge.Oriented(forward ? TopAbs_FORWARD : TopAbs_REVERSED));
      }
      wire.Closed(Standard_True);
      builder.Add(face, wire);
      result.faces.push_back(face);
    }
    return true;
  }

  std::vector<TopoDS_Face> pieces_, removed_;
  const FacetGapOptions& options_;
  const TrueDistance& phi_;
};

}  // namespace

std::optional<FacetedGaps> facetGaps(std::vector<TopoDS_Face> pieces,
                                     const FacetGapOptions& options, const TrueDistance& phi) {
  return GapFaceter(std::move(pieces), options, phi).run();
}

}  // namespace phront::cad
