// What exact patches leave open is little: one crossing that nothing finds spoils one corner of a
// solid. That corner is given up, not the solid. Edges of the pieces around a hole are divided
// until they are nearly straight, then become straight and serve as sides of the facets, so nothing
// has to be sewn. Weak spot: a hole with several loops is known only where pieces were taken away
// or where the front in it reaches them all.
#include "rebuild/facet_gaps.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GeomAPI_ProjectPointOnCurve.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "exchange/measures.h"
#include "exchange/tolerances.h"
#include "judge/check_topology.h"
#include "patches/patch_tools.h"
#include "rebuild/edge_uses.h"
#include "rebuild/facet_bias.h"
#include "rebuild/facet_solid.h"
#include "rebuild/file_faults.h"
#include "rebuild/fuse.h"
#include "rebuild/piece_faults.h"
#include "rebuild/plane_features.h"
#include "rebuild/select.h"
#include "rebuild/straight_edges.h"
#include "tessellate/occt_mesh.h"

namespace phront::cad {
namespace {

constexpr double kMostRemoved = 0.75;            // of the area
constexpr std::array kChords{6e-3, 2e-3, 5e-4};  // of |d|, of the edges around holes: tried in turn
constexpr double kLongestSide = 10;              // of |d|
constexpr double kLooseSides = 0.03;             // of |d|, how far sides may be off a piece
constexpr int kRounds = 5;
constexpr double kStep = 1e-3;       // of |d|, to see which way phi grows
constexpr double kSamePlace = 1e-5;  // of |d|
constexpr Index kMostFacets = 15'000;
constexpr double kMostOff = 0.06;  // of |d|, facets: below what the check allows single points
// How near to the pieces the front gives way: of its grid, at most of |d|.
constexpr double kMarginOfSpacing = 0.5;
constexpr double kMarginOfDistance = 0.3;
constexpr double kMeshOfMargin = 0.2;  // deflection of the pieces' triangles
constexpr double kMeshAngle = 0.5;     // rad

using Loop = std::vector<TopoDS_Edge>;  // oriented along the loop, the hole on the left

Vec3 toVec(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }

class GapFaceter {
 public:
  GapFaceter(std::vector<TopoDS_Face> pieces, const FacetGapOptions& options,
             const IsoSurface& front, const TrueDistance& phi)
      : pieces_(std::move(pieces)), options_(options), front_(front), phi_(phi) {}

  Result<FacetedGaps> run() {
    double area = 0;
    for (const TopoDS_Face& piece : pieces_) area += areaOf(piece);
    lowerToleranceOf(pieces_);
    std::optional<SortedPieces> sorted =
        removeFaultyPieces(std::move(pieces_), options_.distance, phi_);
    if (!sorted) return fail(ErrorCode::Failed, "pieces could not be cut around their faults");
    pieces_ = std::move(sorted->kept);
    removed_ = std::move(sorted->removed);
    turnOutward();
    double gone = 0;
    for (const TopoDS_Face& piece : removed_) gone += areaOf(piece);
    if (gone > kMostRemoved * area || pieces_.empty())
      return fail(ErrorCode::Failed, "too many pieces are at fault");
    const std::vector<TopoDS_Face> whole = pieces_;
    Result<FacetedGaps> result = fail(ErrorCode::Failed, "there is no hole");
    for (const double chord : kChords) {
      pieces_ = whole;
      result = sound(chord * size());
      if (result) return result;
    }
    return result;
  }

 private:
  /// Pieces around holes that do not stand what is done to them go, too.
  Result<FacetedGaps> sound(double chord) {
    const double margin = std::min(kMarginOfSpacing * front_.spacing, kMarginOfDistance * size());
    for (int round = 0; round < kRounds; ++round) {
      std::vector<TopoDS_Face> straight = pieces_;
      std::vector<std::size_t> bad =
          straightenOpenEdges(straight, {chord, kLongestSide * size(), kLooseSides * size()});
      std::optional<SurfaceDistance> around;
      if (bad.empty()) around = trianglesAround(straight, margin, bad);
      if (around) {
        std::optional<std::vector<Loop>> loops = openLoops(straight);
        if (!loops) return fail(ErrorCode::Failed, "the edges of a hole do not close");
        if (loops->empty()) return fail(ErrorCode::Failed, "there is no hole");
        Result<FacetedGaps> filled =
            facetsIn(straight, holesOf(std::move(*loops)), *around, margin);
        if (!filled) return filled;
        if (!valid(*filled)) return fail(ErrorCode::Failed, "facets in a hole cross its edges");
        const std::vector<Vec3> faults =
            faultsInFile(filled->faces, kLooseSides * size(),
                         usualMeshSize({diagonal(), options_.distance, true}));
        if (faults.empty()) return filled;
        bad = piecesAt(faults, *around, margin);
        if (bad.empty()) return fail(ErrorCode::Failed, "facets in a hole come back from no file");
      }
      if (bad.size() >= pieces_.size()) break;
      remove(bad);
    }
    return fail(ErrorCode::Failed, "pieces around a hole are at fault");
  }

  static std::vector<std::size_t> piecesAt(const std::vector<Vec3>& points,
                                           const SurfaceDistance& around, double reach) {
    std::set<std::size_t> numbers;
    for (const Vec3& x : points) {
      const FootPoint foot = around.foot(x, reach);
      if (foot.triangle != kNone)
        numbers.insert(static_cast<std::size_t>(around.mesh().face(foot.triangle)));
    }
    return {numbers.begin(), numbers.end()};
  }

  void remove(const std::vector<std::size_t>& bad) {
    std::vector<TopoDS_Face> kept;
    for (std::size_t f = 0; f < pieces_.size(); ++f) {
      const bool goes = std::find(bad.begin(), bad.end(), f) != bad.end();
      (goes ? removed_ : kept).push_back(pieces_[f]);
    }
    pieces_ = std::move(kept);
  }

  /// A narrow triangle next to an edge that is not straight enough may be crossed by it.
  static bool valid(const FacetedGaps& result) {
    return std::all_of(result.faces.end() - result.facets, result.faces.end(),
                       [](const TopoDS_Face& face) { return BRepCheck_Analyzer(face).IsValid(); });
  }

  [[nodiscard]] double size() const { return std::abs(options_.distance); }
  [[nodiscard]] double diagonal() const { return phi_.surface().box().diagonal().norm(); }

  /// What fusing leaves is many times what it bridges, and swallows what is near.
  void lowerToleranceOf(const std::vector<TopoDS_Face>& pieces) const {
    const BRep_Builder builder;
    TopoDS_Compound all;
    builder.MakeCompound(all);
    for (const TopoDS_Face& piece : pieces) builder.Add(all, piece);
    lowerTolerances(all, kSamePlace * size());
  }

  void turnOutward() {
    for (TopoDS_Face& piece : pieces_) {
      const std::vector<FaceSample> samples = interiorSamples(piece);
      if (!samples.empty() &&
          !facesOutward(samples.front(), samples.front().normal, kStep * size(), phi_))
        piece.Reverse();
    }
  }

  /// Simple loops of edges that one piece uses; empty when they do not close.
  [[nodiscard]] std::optional<std::vector<Loop>> openLoops(
      const std::vector<TopoDS_Face>& pieces) const {
    const EdgeUses uses(pieces);
    TopTools_IndexedMapOfShape vertices;
    std::map<int, std::vector<TopoDS_Edge>> from;  // directed edges by first vertex
    std::size_t left = 0;
    for (std::size_t e = 0; e < uses.faces.size(); ++e) {
      if (uses.faces[e].size() != 1) continue;
      // As the piece uses it the piece is on the left, seen from outside.
      const TopoDS_Edge along = TopoDS::Edge(uses.edge(e).Reversed());
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
  /// Whether the edge that x bounds a part of was divided from the curve.
  [[nodiscard]] bool isOn(const BRepAdaptor_Curve& curve, const gp_Pnt& x) const {
    const gp_Pnt ends[] = {curve.Value(curve.FirstParameter()), curve.Value(curve.LastParameter())};
    if (std::min(x.Distance(ends[0]), x.Distance(ends[1])) <= kSamePlace * size()) return true;
    const GeomAPI_ProjectPointOnCurve foot(x, curve.Curve().Curve(), curve.FirstParameter(),
                                           curve.LastParameter());
    return foot.NbPoints() > 0 && foot.LowerDistance() <= kSamePlace * size();
  }

  /// The pieces as triangles; empty where some are `bad`.
  [[nodiscard]] std::optional<SurfaceDistance> trianglesAround(
      const std::vector<TopoDS_Face>& pieces, double margin, std::vector<std::size_t>& bad) const {
    TriMesh triangles;
    for (std::size_t f = 0; f < pieces.size(); ++f) {
      const ShapeMesh mesh =
          meshShape(pieces[f], ShapeMaps(pieces[f]), kMeshOfMargin * margin, kMeshAngle);
      BRepTools::Clean(pieces[f]);  // edges are shared with what follows
      if (!mesh.failed.empty()) bad.push_back(f);
      for (const FaceMesh& face : mesh.faces) {
        const auto first = static_cast<Index>(triangles.points.size());
        triangles.points.insert(triangles.points.end(), face.nodes.begin(), face.nodes.end());
        for (const std::array<Index, 3>& t : face.triangles) {
          triangles.triangles.push_back({first + t[0], first + t[1], first + t[2]});
          triangles.faceOf.push_back(static_cast<Index>(f));
        }
      }
    }
    if (!bad.empty()) return std::nullopt;
    Result<SurfaceDistance> around = SurfaceDistance::build(std::move(triangles));
    if (!around) return std::nullopt;
    return std::move(*around);
  }

  /// By the part's triangles and by its faces: where edges of the part lie off its faces the two
  /// disagree, and no facet is right by both.
  [[nodiscard]] bool onLevel(const FacetedSurface& facets) const {
    const auto off = [&](const Vec3& x) {
      const TrueDistance::Foot foot = phi_.foot(x);
      return std::max(std::abs(foot.distance - size()), std::abs(foot.meshDistance - size()));
    };
    for (const FacetPolygon& polygon : facets.polygons) {
      const std::vector<Index>& corners = polygon.loops.front();
      if (corners.size() != 3) continue;  // of a plane
      Vec3 middle = Vec3::Zero();
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& a = facets.points[static_cast<std::size_t>(corners[k])];
        const Vec3& b = facets.points[static_cast<std::size_t>(corners[(k + 1) % 3])];
        if (off(0.5 * (a + b)) > kMostOff * size()) return false;
        middle += a / 3;
      }
      if (off(middle) > kMostOff * size()) return false;
    }
    return true;
  }

  Result<FacetedGaps> facetsIn(const std::vector<TopoDS_Face>& pieces,
                               const std::vector<std::vector<Loop>>& holes,
                               const SurfaceDistance& around, double margin) const {
    SurfaceHoles openings{{}, around, margin};
    std::vector<Loop> borders;
    Index fixedPoints = 0;
    for (const std::vector<Loop>& hole : holes) {
      openings.loops.emplace_back();
      for (const Loop& loop : hole) {
        std::vector<Vec3>& corners = openings.loops.back().emplace_back();
        for (const TopoDS_Edge& edge : loop)
          corners.push_back(toVec(BRep_Tool::Pnt(TopExp::FirstVertex(edge, Standard_True))));
        borders.push_back(loop);
        fixedPoints += static_cast<Index>(loop.size());
      }
    }
    FacetOptions with;
    with.tolerance = options_.tolerance;
    with.maxFacets = kMostFacets;
    with.planeOfFace = options_.planeOfFace;
    with.threads = 1;  // a guarded child starts no thread
    Result<FacetedSurface> patch =
        facetHoles(phi_.surface(), front_, options_.distance, openings, with);
    if (!patch) return tl::unexpected<Error>(patch.error());
    removeChordalBias(*patch, fixedPoints, options_.distance, phi_);
    if (!onLevel(*patch))
      return fail(ErrorCode::Failed, "facets in a hole are too far off the distance");
    const Result<std::vector<TopoDS_Face>> facets = facesOfFacets(*patch, borders);
    if (!facets) return tl::unexpected<Error>(facets.error());
    FacetedGaps result;
    result.faces = pieces;
    result.faces.insert(result.faces.end(), facets->begin(), facets->end());
    result.facets = static_cast<int>(facets->size());
    result.curvedFacets = curvedFacets(*patch, options_.planeOfFace);
    settleTolerances(result.faces);
    return result;
  }

  std::vector<TopoDS_Face> pieces_, removed_;
  const FacetGapOptions& options_;
  const IsoSurface& front_;
  const TrueDistance& phi_;
};

}  // namespace

Result<FacetedGaps> facetGaps(std::vector<TopoDS_Face> pieces, const FacetGapOptions& options,
                              const IsoSurface& front, const TrueDistance& phi) {
  return GapFaceter(std::move(pieces), options, front, phi).run();
}

}  // namespace phront::cad
