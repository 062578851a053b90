// The moved face, the neighbours extended and all faces of the solid divide space into cells. What
// lies between a face and where it is moved to are the cells beside the face: outside of the solid
// they are added, inside they are taken away. How neighbours' extensions divide them is of no
// matter, nor are extensions that lead nowhere.
#include "move/move_group.h"

#include <BOPAlgo_MakerVolume.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepClass3d_SolidClassifier.hxx>
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
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "exchange/face_set.h"
#include "move/extended_faces.h"
#include "patches/edge_table.h"
#include "patches/patch_tools.h"
#include "rebuild/cells.h"
#include "rebuild/select.h"

namespace phront::cad {
namespace {

constexpr double kOnSurface = 1e-6;              // of the diagonal
constexpr double kSteps[] = {0.05, 5e-3, 5e-4};  // of the distance: from a wall into its cell

class GroupMover {
 public:
  GroupMover(const TopoDS_Shape& solid, const GroupMove& move)
      : solid_(solid),
        move_(move),
        moved_(move.faces.begin(), move.faces.end()),
        table_(makeEdgeTable(solid, 1, kSmoothNeighbours)),
        tolerance_(kOnSurface * diagonalOf(solid)) {}

  Result<MovedSolid> run() {
    Result<std::vector<ExtendedFace>> extended = extendedFaces(table_, move_, tolerance_);
    if (!extended) return tl::unexpected(extended.error());
    extended_ = std::move(*extended);
    BOPAlgo_MakerVolume cells;
    TopTools_ListOfShape arguments;
    for (const TopoDS_Face& face : table_.faces) arguments.Append(face);
    for (const ExtendedFace& other : extended_) arguments.Append(other.face);
    cells.SetArguments(arguments);
    cells.SetIntersect(true);
    cells.Perform();
    if (cells.HasErrors()) return cannotMove(move_, "nothing closes there");
    const TopoDS_Shape whole = wholeOf(cells);
    if (whole.IsNull()) return cannotMove(move_, "its neighbours do not meet it there");
    return traced(united(whole, cells));
  }

 private:
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
            std::any_of(extended_.begin(), extended_.end(), [&](const ExtendedFace& other) {
              return moved_.count(other.origin) > 0 && distanceTo(other.face, s.point) <= most;
            });
        if (!near) return false;
      }
    }
    return true;
  }

  /// The solid of the cells that belong to it; null when it does not close.
  [[nodiscard]] TopoDS_Shape wholeOf(BOPAlgo_MakerVolume& cells) const {
    TopTools_MapOfShape beside;  // pieces of the faces that move
    for (const int index : move_.faces) {
      const TopoDS_Face& face = table_.faces[static_cast<std::size_t>(index)];
      beside.Add(face);
      for (const TopoDS_Shape& piece : cells.Modified(face)) beside.Add(piece);
    }
    BRepClass3d_SolidClassifier inSolid(solid_);
    std::vector<TopoDS_Shape> chosen;
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
      if (belongs) chosen.push_back(cell);
    }
    TopTools_ListOfShape skin;
    for (const TopoDS_Face& face : skinOf(chosen)) skin.Append(face);
    if (!changed || skin.IsEmpty()) return {};
    BOPAlgo_MakerVolume whole;
    whole.SetArguments(skin);
    whole.SetIntersect(false);
    whole.Perform();
    if (whole.HasErrors()) return {};
    // One solid has all of the skin; others are its voids.
    for (TopExp_Explorer it(whole.Shape(), TopAbs_SOLID); it.More(); it.Next()) {
      if (static_cast<int>(facesOf(it.Current()).size()) == skin.Extent()) return it.Current();
    }
    return {};
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
    if (!BRepCheck_Analyzer(whole).IsValid())
      return cannotMove(move_, "what comes of it is not valid");
    MovedSolid result{whole, {}};
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(whole, TopAbs_FACE, faces);
    std::set<int> present;
    for (int f = 1; f <= faces.Extent(); ++f) {
      int origin = -1;
      for (const FaceSample& s : interiorSamples(TopoDS::Face(faces(f)))) {
        const int here = originAt(s.point);
        if (here < 0) return cannotMove(move_, "what comes of it does not lie on the part's faces");
        if (origin < 0) origin = here;
      }
      if (origin < 0) return cannotMove(move_, "what comes of it has a face of no size");
      result.origins.push_back(origin);
      present.insert(origin);
    }
    for (const int index : move_.faces) {
      if (present.count(index) == 0) return cannotMove(move_, "nothing would be left of it");
    }
    return result;
  }

  [[nodiscard]] int originAt(const gp_Pnt& point) const {
    for (std::size_t f = 0; f < table_.faces.size(); ++f) {
      if (moved_.count(static_cast<int>(f)) == 0 && distanceTo(table_.faces[f], point) < tolerance_)
        return static_cast<int>(f);
    }
    for (const ExtendedFace& other : extended_)
      if (distanceTo(other.face, point) < tolerance_) return other.origin;
    return -1;
  }

  TopoDS_Shape solid_;
  const GroupMove& move_;
  std::set<int> moved_;
  EdgeTable table_;
  double tolerance_;  ///< mm
  std::vector<ExtendedFace> extended_;
};

}  // namespace

Result<MovedSolid> moveGroup(const TopoDS_Shape& solid, const GroupMove& move) {
  return GroupMover(solid, move).run();
}

}  // namespace phront::cad
