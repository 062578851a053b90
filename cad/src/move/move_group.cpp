// The moved face, the neighbours extended and all faces of the solid divide space into cells. What
// lies between a face and where it is moved to are the cells beside the face: outside of the solid
// they are added, inside they are taken away. How neighbours' extensions divide them is of no
// matter, nor are extensions that lead nowhere.
#include "move/move_group.h"

#include <fmt/format.h>

#include <BOPAlgo_MakerVolume.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepClass3d_SolidClassifier.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepLProp_SLProps.hxx>
#include <BRepLib.hxx>
#include <BRep_Tool.hxx>
#include <Geom_OffsetSurface.hxx>
#include <Precision.hxx>
#include <ShapeUpgrade_UnifySameDomain.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "exchange/face_set.h"
#include "move/reaching_face.h"
#include "patches/edge_table.h"
#include "patches/patch_tools.h"
#include "rebuild/select.h"

namespace phront::cad {
namespace {

constexpr int kEdgeSamples = 24;
constexpr double kBeyond = 1.5;                  // of the way to where surfaces meet
constexpr double kOnSurface = 1e-6;              // of the diagonal
constexpr double kSteps[] = {0.05, 5e-3, 5e-4};  // of the distance: from a wall into its cell

/// What a face of the result may lie on.
struct Source {
  TopoDS_Face face;
  int origin = -1;
};

class GroupMover {
 public:
  GroupMover(const TopoDS_Shape& solid, const GroupMove& move)
      : solid_(solid),
        move_(move),
        moved_(move.faces.begin(), move.faces.end()),
        table_(makeEdgeTable(solid, 1, kSmoothNeighbours)),
        tolerance_(kOnSurface * diagonalOf(solid)) {}

  Result<MovedSolid> run() {
    if (Result<void> found = collectBeyond(); !found) return tl::unexpected(found.error());
    if (Result<void> made = makeSources(); !made) return tl::unexpected(made.error());
    BOPAlgo_MakerVolume cells;
    TopTools_ListOfShape arguments;
    for (const TopoDS_Face& face : table_.faces) arguments.Append(face);
    for (const Source& source : extended_) arguments.Append(source.face);
    cells.SetArguments(arguments);
    cells.SetIntersect(true);
    cells.Perform();
    if (cells.HasErrors()) return cannotMove("nothing closes there");
    const TopoDS_Shape whole = skinOf(cells);
    if (whole.IsNull()) return cannotMove("its neighbours do not meet it there");
    return traced(united(whole, cells));
  }

 private:
  [[nodiscard]] int numberOf(int face) const {
    return move_.numbers[static_cast<std::size_t>(face)];
  }
  [[nodiscard]] tl::unexpected<Error> cannotMove(const std::string& why) const {
    return fail(ErrorCode::NotSupported,
                fmt::format("face F{} cannot be moved by {:g} mm: {}",
                            numberOf(move_.faces.front()), move_.distance, why));
  }

  /// Where the moved faces and their neighbours must reach, by face.
  Result<void> collectBeyond() {
    for (const EdgeInfo& edge : table_.edges) {
      const bool first = moved_.count(edge.face1) > 0;
      const bool second = moved_.count(edge.face2) > 0;
      if (first == second || edge.face2 < 0) continue;
      const int face = first ? edge.face1 : edge.face2;
      const int neighbour = first ? edge.face2 : edge.face1;
      for (const EdgeSample& s : edge.samples) {
        const double sine = s.n1.Crossed(s.n2).Magnitude();
        if (sine < kSmoothNeighbours) {
          if (Result<void> met = meetSmooth(face, neighbour, s.point, first ? s.n1 : s.n2); !met)
            return met;
          continue;
        }
        const double length = kBeyond * std::abs(move_.distance) / sine;
        const gp_Vec& up = first ? s.n1 : s.n2;
        const gp_Vec& aside = first ? s.n2 : s.n1;
        const double away = s.angle > 0 ? 1 : -1;
        beyond_[face].push_back(
            s.point.Translated(move_.distance * up + length * along(up, s.tangent, away * aside)));
        // Elsewhere the neighbour is there already.
        if (away * move_.distance < 0) continue;
        const gp_Vec across = length * along(aside, s.tangent, away * up);
        beyond_[neighbour].push_back(s.point.Translated(across));
        // Neighbours that lean may have to be wider there.
        const bool atStart = &s == &edge.samples.front();
        if ((atStart || &s == &edge.samples.back()) && !goesOnSmoothly(neighbour, edge, atStart))
          beyond_[neighbour].push_back(
              s.point.Translated(across + (atStart ? -length : length) * s.tangent));
      }
    }
    return {};
  }

  /// A plane may move to the side that a smooth neighbour bends to, and cut it.
  Result<void> meetSmooth(int face, int neighbour, const gp_Pnt& point, const gp_Vec& normal) {
    const TopoDS_Face& plane = table_.faces[static_cast<std::size_t>(face)];
    double bend = 0;
    for (const gp_Pnt& p : outlineOf(table_.faces[static_cast<std::size_t>(neighbour)])) {
      const double height = gp_Vec(point, p).Dot(normal);
      if (std::abs(height) > std::abs(bend)) bend = height;
      beyond_[face].push_back(p.Translated((move_.distance - height) * normal));
    }
    if (BRepAdaptor_Surface(plane).GetType() == GeomAbs_Plane && std::abs(bend) > tolerance_ &&
        bend * move_.distance > 0)
      return {};
    return cannotMove(fmt::format("face F{} goes on smoothly into F{}; give both the same distance",
                                  numberOf(face), numberOf(neighbour)));
  }

  /// Whether the face has a smooth edge at an end of this one.
  [[nodiscard]] bool goesOnSmoothly(int face, const EdgeInfo& at, bool atStart) const {
    const TopoDS_Vertex vertex =
        atStart ? TopExp::FirstVertex(at.edge) : TopExp::LastVertex(at.edge);
    return std::any_of(table_.edges.begin(), table_.edges.end(), [&](const EdgeInfo& other) {
      return other.smooth && (other.face1 == face || other.face2 == face) &&
             (TopExp::FirstVertex(other.edge).IsSame(vertex) ||
              TopExp::LastVertex(other.edge).IsSame(vertex));
    });
  }

  /// Unit, tangent to the face with this normal and across the edge, towards `side`.
  static gp_Vec along(const gp_Vec& normal, const gp_Vec& tangent, const gp_Vec& side) {
    const gp_Vec across = normal.Crossed(tangent).Normalized();
    return across.Dot(side) > 0 ? across : across.Reversed();
  }

  Result<void> makeSources() {
    for (const int index : move_.faces) {
      const TopoDS_Face& face = table_.faces[static_cast<std::size_t>(index)];
      if (BRepAdaptor_Surface(face).GetType() > GeomAbs_Torus)
        return cannotMove("only planes, cylinders, cones, spheres and tori can be moved alone");
      const Handle(Geom_OffsetSurface) offset =
          new Geom_OffsetSurface(BRep_Tool::Surface(face), sideOf(face) * move_.distance);
      const Handle(Geom_Surface) surface = offset->Surface();
      std::vector<gp_Pnt> outline;
      if (!surface.IsNull()) outline = movedOutline(face);
      if (outline.empty()) return cannotMove("its radius is no larger than that");
      extended_.push_back({reachingFace(surface, face, outline, beyond_[index]), index});
    }
    for (const auto& [index, points] : beyond_) {
      if (moved_.count(index) > 0) continue;
      const TopoDS_Face& face = table_.faces[static_cast<std::size_t>(index)];
      TopoDS_Face reaching = reachingFace(BRep_Tool::Surface(face), face, outlineOf(face), points);
      if (reaching.IsNull()) {  // freeform
        double farthest = 0;
        for (const gp_Pnt& p : points) farthest = std::max(farthest, distanceTo(face, p));
        BRepLib::ExtendFace(face, farthest, true, true, true, true, reaching);
      }
      extended_.push_back({reaching, index});
    }
    for (const Source& source : extended_) {
      if (source.face.IsNull())
        return cannotMove(fmt::format("face F{} cannot be extended", numberOf(source.origin)));
    }
    return {};
  }

  /// Empty when the face would move beyond its axis, apex or centre.
  [[nodiscard]] std::vector<gp_Pnt> movedOutline(const TopoDS_Face& face) const {
    const double along = sideOf(face) * move_.distance;
    std::vector<gp_Pnt> points;
    const BRepAdaptor_Surface surface(face);
    BRepLProp_SLProps at(surface, 2, Precision::Confusion());
    for (const TopoDS_Edge& edge : edgesOf(face)) {
      double first = 0;
      double last = 0;
      const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
      if (curve.IsNull()) continue;
      for (int i = 0; i <= kEdgeSamples; ++i) {
        const double share = static_cast<double>(i) / kEdgeSamples;
        const gp_Pnt2d uv = curve->Value(std::lerp(first, last, share));
        at.SetParameters(uv.X(), uv.Y());
        if (!at.IsNormalDefined()) continue;
        points.push_back(at.Value().Translated(along * gp_Vec(at.Normal())));
        if (!at.IsCurvatureDefined()) continue;
        if (1 - along * at.MaxCurvature() <= 0 || 1 - along * at.MinCurvature() <= 0) return {};
      }
    }
    return points;
  }

  /// Of the outward normal against the surface's own.
  static double sideOf(const TopoDS_Face& face) {
    return face.Orientation() == TopAbs_REVERSED ? -1 : 1;
  }

  static double distanceTo(const TopoDS_Shape& shape, const gp_Pnt& point) {
    const BRepExtrema_DistShapeShape distance(BRepBuilderAPI_MakeVertex(point).Vertex(), shape);
    return distance.IsDone() ? distance.Value() : Precision::Infinite();
  }

  /// A point inside the cell; empty when none was found.
  [[nodiscard]] std::optional<gp_Pnt> pointIn(const TopoDS_Shape& cell) const {
    BRepClass3d_SolidClassifier classifier(cell);
    for (const double step : kSteps) {
      for (const TopoDS_Face& face : facesOf(cell)) {
        for (const FaceSample& s : interiorSamples(face)) {
          const gp_Pnt p = s.point.Translated(-step * std::abs(move_.distance) * s.normal);
          classifier.Perform(p, Precision::Confusion());
          if (classifier.State() == TopAbs_IN) return p;
        }
      }
    }
    return std::nullopt;
  }

  /// No point of a cell that is added or removed is farther from the moved faces than these move.
  [[nodiscard]] bool isBetween(const TopoDS_Shape& cell) const {
    const double most = std::abs(move_.distance) + tolerance_;
    for (const TopoDS_Face& wall : facesOf(cell)) {
      for (const FaceSample& s : interiorSamples(wall)) {
        const bool near =
            std::any_of(extended_.begin(), extended_.end(), [&](const Source& source) {
              return moved_.count(source.origin) > 0 && distanceTo(source.face, s.point) <= most;
            });
        if (!near) return false;
      }
    }
    return true;
  }

  /// The solid of the cells that belong to it; null when it does not close.
  [[nodiscard]] TopoDS_Shape skinOf(BOPAlgo_MakerVolume& cells) const {
    TopTools_MapOfShape beside;  // pieces of the faces that move
    for (const int index : move_.faces) {
      const TopoDS_Face& face = table_.faces[static_cast<std::size_t>(index)];
      beside.Add(face);
      for (const TopoDS_Shape& piece : cells.Modified(face)) beside.Add(piece);
    }
    BRepClass3d_SolidClassifier inSolid(solid_);
    TopTools_IndexedMapOfShape faces;
    std::vector<TopoDS_Face> asUsed;
    std::vector<int> uses;
    bool changed = false;
    for (TopExp_Explorer it(cells.Shape(), TopAbs_SOLID); it.More(); it.Next()) {
      const TopoDS_Shape& cell = it.Current();
      const std::optional<gp_Pnt> point = pointIn(cell);
      if (!point) return {};
      inSolid.Perform(*point, Precision::Confusion());
      bool belongs = inSolid.State() == TopAbs_IN;
      const std::vector<TopoDS_Face> walls = facesOf(cell);
      const bool atFace = std::any_of(walls.begin(), walls.end(),
                                      [&](const TopoDS_Face& w) { return beside.Contains(w); });
      if (atFace && belongs == (move_.distance < 0)) {
        if (!isBetween(cell)) return {};
        belongs = !belongs;
        changed = true;
      }
      if (!belongs) continue;
      for (const TopoDS_Face& wall : walls) {
        if (wall.Orientation() != TopAbs_FORWARD && wall.Orientation() != TopAbs_REVERSED) continue;
        const auto f = static_cast<std::size_t>(faces.Add(wall));
        if (uses.size() < f) {
          uses.push_back(0);
          asUsed.push_back(wall);
        }
        ++uses[f - 1];
      }
    }
    TopTools_ListOfShape skin;
    for (std::size_t f = 0; f < uses.size(); ++f)
      if (uses[f] == 1) skin.Append(asUsed[f]);
    if (!changed || skin.IsEmpty()) return {};
    BOPAlgo_MakerVolume whole;
    whole.SetArguments(skin);
    whole.SetIntersect(false);
    whole.Perform();
    if (whole.HasErrors()) return {};
    TopTools_IndexedMapOfShape solids;
    TopExp::MapShapes(whole.Shape(), TopAbs_SOLID, solids);
    return solids.Extent() == 1 ? solids(1) : TopoDS_Shape();
  }

  /// Without the edges that only extensions have left; those of the part stay.
  [[nodiscard]] TopoDS_Shape united(const TopoDS_Shape& whole, BOPAlgo_MakerVolume& cells) const {
    ShapeUpgrade_UnifySameDomain unify(whole, Standard_True, Standard_True, Standard_False);
    for (const EdgeInfo& edge : table_.edges) {
      const bool seam = edge.face1 == edge.face2;
      if (seam || moved_.count(edge.face1) + moved_.count(edge.face2) > 0) continue;
      unify.KeepShape(edge.edge);
      for (const TopoDS_Shape& piece : cells.Modified(edge.edge)) unify.KeepShape(piece);
    }
    unify.Build();
    return BRepCheck_Analyzer(unify.Shape()).IsValid() ? unify.Shape() : whole;
  }

  /// Every face of the result lies on a face of the part, or an extension of one.
  [[nodiscard]] Result<MovedSolid> traced(const TopoDS_Shape& whole) const {
    if (!BRepCheck_Analyzer(whole).IsValid()) return cannotMove("what comes of it is not valid");
    MovedSolid result{whole, {}};
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(whole, TopAbs_FACE, faces);
    std::set<int> present;
    for (int f = 1; f <= faces.Extent(); ++f) {
      int origin = -1;
      for (const FaceSample& s : interiorSamples(TopoDS::Face(faces(f)))) {
        const int here = originAt(s.point);
        if (here < 0) return cannotMove("what comes of it does not lie on the part's faces");
        if (origin < 0) origin = here;
      }
      if (origin < 0) return cannotMove("what comes of it has a face of no size");
      result.origins.push_back(origin);
      present.insert(origin);
    }
    for (const int index : move_.faces) {
      if (present.count(index) == 0) return cannotMove("nothing would be left of it");
    }
    return result;
  }

  [[nodiscard]] int originAt(const gp_Pnt& point) const {
    for (std::size_t f = 0; f < table_.faces.size(); ++f) {
      if (moved_.count(static_cast<int>(f)) == 0 && distanceTo(table_.faces[f], point) < tolerance_)
        return static_cast<int>(f);
    }
    for (const Source& source : extended_)
      if (distanceTo(source.face, point) < tolerance_) return source.origin;
    return -1;
  }

  TopoDS_Shape solid_;
  const GroupMove& move_;
  std::set<int> moved_;
  EdgeTable table_;
  double tolerance_;  ///< mm
  std::map<int, std::vector<gp_Pnt>> beyond_;
  std::vector<Source> extended_;
};

}  // namespace

Result<MovedSolid> moveGroup(const TopoDS_Shape& solid, const GroupMove& move) {
  return GroupMover(solid, move).run();
}

}  // namespace phront::cad
