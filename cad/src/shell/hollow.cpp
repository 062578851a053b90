#include "shell/hollow.h"

#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepClass3d_SolidClassifier.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Solid.hxx>
#include <algorithm>

#include "exchange/face_set.h"
#include "exchange/measures.h"
#include "patches/patch_tools.h"
#include "rebuild/fuse.h"
#include "rebuild/select.h"

namespace phront::cad {
namespace {

constexpr double kOnOpening = 1e-6;  // of the diagonal
constexpr double kInside = 1e-7;     // mm, tolerance of the classifiers

bool insideAny(const std::vector<TopoDS_Shape>& solids, const gp_Pnt& point) {
  return std::any_of(solids.begin(), solids.end(), [&](const TopoDS_Shape& solid) {
    return BRepClass3d_SolidClassifier(solid, point, kInside).State() == TopAbs_IN;
  });
}

class Hollower {
 public:
  explicit Hollower(const HollowRequest& request)
      : request_(request), diagonal_(diagonalOf(request.solid)) {
    TopTools_IndexedMapOfShape map;
    TopExp::MapShapes(request.solid, TopAbs_FACE, map);
    TopTools_MapOfShape open;
    for (const int f : request.open) open.Add(map(f + 1));
    for (const TopoDS_Face& face : facesOf(request.solid))
      (open.Contains(face) ? open_ : wall_).push_back(face);
  }

  Result<TopoDS_Shape> run() {
    if (Result<void> cut = cutOpenings(); !cut) return tl::unexpected(cut.error());
    FaceSet all = wall_;
    all.insert(all.end(), cavity_.begin(), cavity_.end());
    if (!edgeUse(all).closed()) return fail(ErrorCode::Failed, "the wall does not close");
    return solidOf(all);
  }

 private:
  /// What is left of the openings joins the wall, what is left of the cavities is `cavity_`.
  Result<void> cutOpenings() {
    std::vector<TopoDS_Face> faces = open_;
    for (const TopoDS_Shape& cavity : request_.cavities)
      for (const TopoDS_Face& face : facesOf(cavity)) faces.push_back(face);
    const std::size_t openings = open_.size();
    const auto mayCross = [openings](std::size_t i, std::size_t j) {
      return (i < openings) != (j < openings);
    };
    const Result<std::vector<TopoDS_Face>> pieces =
        openings == 0 ? faces : splitFaces(faces, request_.fuzzy, mayCross);
    if (!pieces) return tl::unexpected(pieces.error());
    for (const TopoDS_Face& piece : *pieces) {
      const std::vector<FaceSample> samples = interiorSamples(piece);
      if (samples.empty()) return fail(ErrorCode::Failed, "a piece of the wall has no inside");
      const gp_Pnt& point = samples.front().point;
      if (onOpening(point)) {
        if (!insideAny(request_.cavities, point)) wall_.push_back(piece);
      } else if (!insideAny(request_.continuations, point)) {
        cavity_.push_back(TopoDS::Face(piece.Reversed()));
      }
    }
    return {};
  }

  [[nodiscard]] bool onOpening(const gp_Pnt& point) const {
    return std::any_of(open_.begin(), open_.end(), [&](const TopoDS_Face& face) {
      const BRepExtrema_DistShapeShape distance(BRepBuilderAPI_MakeVertex(point), face);
      return distance.IsDone() && distance.Value() < kOnOpening * diagonal_;
    });
  }

  /// Cavities that reach no opening are voids of the only solid.
  static Result<TopoDS_Shape> solidOf(FaceSet all) {
    if (orientAlike(all) < 0) return fail(ErrorCode::Failed, "the wall has no outside");
    BRepBuilderAPI_MakeSolid solid;
    int outer = 0;
    for (const FaceSet& component : componentsOf(all)) {
      const TopoDS_Shell shell = shellOf(component);
      const bool voids = volumeOf(shell) < 0;
      if (!voids) ++outer;
      solid.Add(shell);
    }
    if (outer != 1 || !solid.IsDone()) return fail(ErrorCode::Failed, "the wall falls apart");
    const TopoDS_Shape wall = solid.Solid();
    return wall;
  }

  const HollowRequest& request_;
  double diagonal_;
  FaceSet open_;
  FaceSet wall_;
  FaceSet cavity_;
};

}  // namespace

Result<TopoDS_Shape> hollowOut(const HollowRequest& request) { return Hollower(request).run(); }

}  // namespace phront::cad
