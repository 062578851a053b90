// Hollowing a solid is an inward offset whose openings do not move. Extended straight through its
// openings, the solid has no boundary near them that could hold the offset back, and the offset of
// the extended solid, cut by the solid, is the cavity.
// Weak spot: a prism that meets a far part of the solid merges with it; the check of the shell sees
// that.
#include "shell/opening.h"

#include <fmt/format.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepLib.hxx>
#include <BRepOffsetAPI_DraftAngle.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRep_Tool.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Solid.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Ax1.hxx>
#include <gp_Ax2.hxx>
#include <gp_Pln.hxx>
#include <map>
#include <numeric>

#include "exchange/face_set.h"
#include "patches/edge_table.h"
#include "patches/patch_tools.h"

namespace phront::cad {
namespace {

constexpr double kPlanarity = 1e-6;    // of the diagonal
constexpr double kSmoothAngle = 1e-3;  // rad: open neighbours that form one plane
constexpr double kRisesFrom =
    1.55;  // rad: a concave edge as sharp as this stands in the prism's way
// rad, between the normals of an open face and its neighbour: an outer wall ends in the plane of
// the opening within 1 / sin of it, in walls, from the rim.
constexpr double kLeastOutwards = 0.75;
constexpr double kSewing[] = {1e-6, 1e-5};  // of the diagonal

/// A planar open face: its plane as seen from the material.
struct OpenFace {
  int index = 0;
  TopoDS_Face face;
  gp_Pnt point;
  gp_Dir normal;  ///< out of the material
};

Result<OpenFace> openFace(const EdgeTable& table, int index, int number, double diagonal) {
  const TopoDS_Face& face = table.faces[static_cast<std::size_t>(index)];
  const BRepAdaptor_Surface surface(face);
  const gp_Pnt2d middle(0.5 * (surface.FirstUParameter() + surface.LastUParameter()),
                        0.5 * (surface.FirstVParameter() + surface.LastVParameter()));
  const std::optional<gp_Vec> normal = outwardNormal(face, middle);
  if (!isPlanar(face, diagonal) || !normal) {
    return fail(ErrorCode::NotSupported,
                fmt::format("face F{} is not planar: only planar faces can be left open", number));
  }
  return OpenFace{index, face, surface.Value(middle.X(), middle.Y()), gp_Dir(*normal)};
}

/// Where open faces meet, and where they meet others.
class Extender {
 public:
  Extender(const TopoDS_Shape& solid, double height, bool outwards, int firstNumber)
      : solid_(solid),
        table_(makeEdgeTable(solid, 1, kSmoothAngle)),
        diagonal_(diagonalOf(solid)),
        height_(height),
        outwards_(outwards),
        firstNumber_(firstNumber) {}

  Result<ThroughOpenings> run(const std::vector<int>& open) {
    for (const int index : open) {
      Result<OpenFace> face = openFace(table_, index, numberOf(index), diagonal_);
      if (!face) return tl::unexpected(face.error());
      slotOf_[index] = static_cast<int>(faces_.size());
      faces_.push_back(*face);
    }
    group_.resize(faces_.size());
    std::iota(group_.begin(), group_.end(), 0);
    for (const EdgeInfo& edge : table_.edges)
      if (isInner(edge)) join(slotOf_[edge.face1], slotOf_[edge.face2]);

    ThroughOpenings made;
    std::vector<TopoDS_Face> boundary;
    for (std::size_t f = 0; f < table_.faces.size(); ++f)
      if (!isOpen(static_cast<int>(f))) boundary.push_back(table_.faces[f]);
    for (int g = 0; g < static_cast<int>(faces_.size()); ++g) {
      if (rootOf(g) != g) continue;
      Result<Opening> opening = makeOpening(g);
      if (!opening) return tl::unexpected(opening.error());
      for (const TopoDS_Face& face : facesOf(opening->continuation))
        if (!liesOnOpening(face, opening->faces)) boundary.push_back(face);
      made.openings.push_back(std::move(*opening));
    }
    made.solid = closed(boundary);
    if (made.solid.IsNull())
      return fail(ErrorCode::Failed, "the solid cannot be extended through its openings");
    return made;
  }

 private:
  [[nodiscard]] int numberOf(int face) const { return firstNumber_ + face; }
  [[nodiscard]] bool isOpen(int face) const { return slotOf_.count(face) > 0; }
  [[nodiscard]] bool isInner(const EdgeInfo& edge) const {
    return edge.face2 >= 0 && isOpen(edge.face1) && isOpen(edge.face2);
  }
  int rootOf(int i) const {
    while (group_[static_cast<std::size_t>(i)] != i) i = group_[static_cast<std::size_t>(i)];
    return i;
  }
  void join(int a, int b) {
    const int root = std::min(rootOf(a), rootOf(b));
    const int other = std::max(rootOf(a), rootOf(b));
    group_[static_cast<std::size_t>(other)] = root;
  }

  /// Null unless it is a valid solid. Prisms share their edges with the solid unless they lean or
  /// are fused: those are sewn.
  [[nodiscard]] TopoDS_Shape closed(const std::vector<TopoDS_Face>& faces) const {
    if (edgeUse(faces).closed()) {
      if (TopoDS_Shape made = solidOf(shellOf(faces)); !made.IsNull()) return made;
    }
    for (const double tolerance : kSewing) {
      BRepBuilderAPI_Sewing sewing(tolerance * diagonal_);
      for (const TopoDS_Face& face : faces) sewing.Add(face);
      sewing.Perform();
      if (TopoDS_Shape made = solidOf(sewing.SewedShape()); !made.IsNull()) return made;
    }
    return {};
  }

  static TopoDS_Shape solidOf(const TopoDS_Shape& shells) {
    BRepBuilderAPI_MakeSolid solid;
    for (TopExp_Explorer it(shells, TopAbs_SHELL); it.More(); it.Next())
      solid.Add(TopoDS::Shell(it.Current()));
    if (!solid.IsDone()) return {};
    TopoDS_Solid made = solid.Solid();
    BRepLib::OrientClosedSolid(made);
    if (!edgeUse(facesOf(made)).closed() || !BRepCheck_Analyzer(made).IsValid()) return {};
    return made;
  }

  [[nodiscard]] bool liesOnOpening(const TopoDS_Face& face, const std::vector<int>& faces) const {
    const BRepAdaptor_Surface surface(face);
    if (surface.GetType() != GeomAbs_Plane) return false;
    const gp_Pln plane = surface.Plane();
    for (const int index : faces) {
      const OpenFace& open = faces_[static_cast<std::size_t>(slotOf_.at(index))];
      if (plane.Axis().Direction().IsParallel(open.normal, kSmoothAngle) &&
          plane.Distance(open.point) < kPlanarity * diagonal_)
        return true;
    }
    return false;
  }

  Result<Opening> makeOpening(int group) {
    Opening opening;
    TopoDS_Shape all;
    const auto add = [&](const TopoDS_Shape& part) {
      all = all.IsNull() ? part : BRepAlgoAPI_Fuse(all, part).Shape();
    };
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      if (rootOf(static_cast<int>(i)) != group) continue;
      opening.faces.push_back(faces_[i].index);
      Result<TopoDS_Shape> prism = prismOn(faces_[i]);
      if (!prism) return tl::unexpected(prism.error());
      add(*prism);
    }
    for (const EdgeInfo& edge : table_.edges)
      if (isInner(edge) && rootOf(slotOf_[edge.face1]) == group && edge.pipe) add(sectorAt(edge));
    for (const TopoDS_Vertex& vertex : innerVertices(opening.faces))
      add(BRepPrimAPI_MakeSphere(BRep_Tool::Pnt(vertex), height_).Shape());
    opening.continuation = all;
    opening.below = belowOf(opening.faces);
    return opening;
  }

  [[nodiscard]] tl::unexpected<Error> refusal(int neighbour, int open, double angle) const {
    const char* how = angle < 0
                          ? "rises from the open face F{}, so that an outer wall would stand in "
                            "the opening"
                          : "goes on from the open face F{} so flatly that an outer wall would "
                            "end in a feather edge";
    return fail(ErrorCode::NotSupported,
                fmt::format("face F{} {}: hollow inwards, or leave another face open",
                            numberOf(neighbour), fmt::format(fmt::runtime(how), numberOf(open))));
  }

  /// Stands on the face. Along a wire that any face rises from it leans inwards, all along: sides
  /// that go on smoothly from one another do so still.
  Result<TopoDS_Shape> prismOn(const OpenFace& open) {
    TopTools_MapOfShape rises;
    for (const EdgeInfo& edge : table_.edges) {
      const bool here = edge.face1 == open.index || edge.face2 == open.index;
      if (!here || isInner(edge) || edge.samples.empty()) continue;
      double least = edge.samples.front().angle;
      for (const EdgeSample& s : edge.samples) least = std::min(least, s.angle);
      if (outwards_ && least < kLeastOutwards)
        return refusal(edge.face1 == open.index ? edge.face2 : edge.face1, open.index, least);
      if (least < -kRisesFrom) rises.Add(edge.edge);
    }
    BRepPrimAPI_MakePrism prism(open.face, height_ * gp_Vec(open.normal));
    std::vector<TopoDS_Face> leaning;
    for (TopExp_Explorer wire(open.face, TopAbs_WIRE); wire.More(); wire.Next()) {
      std::vector<TopoDS_Face> sides;
      bool lean = false;
      for (TopExp_Explorer edge(wire.Current(), TopAbs_EDGE); edge.More(); edge.Next()) {
        lean = lean || rises.Contains(edge.Current());
        for (const TopoDS_Shape& side : prism.Generated(edge.Current()))
          sides.push_back(TopoDS::Face(side));
      }
      if (lean) leaning.insert(leaning.end(), sides.begin(), sides.end());
    }
    if (leaning.empty()) return prism.Shape();
    BRepOffsetAPI_DraftAngle draft(prism.Shape());
    const gp_Pln plane(open.point, open.normal);
    for (const TopoDS_Face& side : leaning) {
      draft.Add(side, open.normal, kDraft, plane);
      if (!draft.AddDone()) break;
    }
    if (draft.AddDone()) draft.Build();
    if (!draft.AddDone() || !draft.IsDone()) {
      return fail(ErrorCode::NotSupported,
                  fmt::format("face F{} cannot be left open: a face rises from it that is neither "
                              "planar nor round",
                              numberOf(open.index)));
    }
    return draft.Shape();
  }

  /// Between the prisms of two open faces that meet at a convex edge.
  [[nodiscard]] TopoDS_Shape sectorAt(const EdgeInfo& edge) const {
    const EdgeSample& s = edge.samples[edge.samples.size() / 2];
    const TopoDS_Shape side = BRepPrimAPI_MakePrism(edge.edge, height_ * s.n1).Shape();
    return BRepPrimAPI_MakeRevol(side, gp_Ax1(s.point, gp_Dir(s.n1.Crossed(s.n2))), s.angle)
        .Shape();
  }

  /// Vertices with open faces all round.
  [[nodiscard]] std::vector<TopoDS_Vertex> innerVertices(const std::vector<int>& faces) const {
    TopTools_IndexedDataMapOfShapeListOfShape facesOf;
    TopExp::MapShapesAndAncestors(solid_, TopAbs_VERTEX, TopAbs_FACE, facesOf);
    std::vector<TopoDS_Vertex> inner;
    for (int i = 1; i <= facesOf.Extent(); ++i) {
      bool allOpen = true;
      bool here = false;
      for (const TopoDS_Shape& face : facesOf(i)) {
        const int index = table_.faceIndex.FindIndex(face) - 1;
        allOpen = allOpen && isOpen(index);
        here = here || std::find(faces.begin(), faces.end(), index) != faces.end();
      }
      if (allOpen && here) inner.push_back(TopoDS::Vertex(facesOf.FindKey(i)));
    }
    return inner;
  }

  [[nodiscard]] TopoDS_Shape belowOf(const std::vector<int>& faces) const {
    TopoDS_Shape below;
    const double size = 4 * (diagonal_ + height_);
    for (const int index : faces) {
      const OpenFace& open = faces_[static_cast<std::size_t>(slotOf_.at(index))];
      const gp_Ax2 axes(open.point, open.normal.Reversed());
      const gp_Pnt corner = open.point.Translated(-0.5 * size * gp_Vec(axes.XDirection()) -
                                                  0.5 * size * gp_Vec(axes.YDirection()));
      const TopoDS_Shape half =
          BRepPrimAPI_MakeBox(gp_Ax2(corner, axes.Direction(), axes.XDirection()), size, size, size)
              .Shape();
      below = below.IsNull() ? half : BRepAlgoAPI_Common(below, half).Shape();
    }
    return below;
  }

  TopoDS_Shape solid_;
  EdgeTable table_;
  double diagonal_;
  double height_;
  bool outwards_;
  int firstNumber_;  ///< of the solid's first face, for sentences
  std::vector<OpenFace> faces_;
  std::map<int, int> slotOf_;  ///< face -> index into faces_
  std::vector<int> group_;
};

}  // namespace

Result<ThroughOpenings> extendThrough(const TopoDS_Shape& solid, const std::vector<int>& open,
                                      double height, bool outwards, int firstNumber) {
  return Extender(solid, height, outwards, firstNumber).run(open);
}

}  // namespace phront::cad
