// BOPAlgo_Builder intersects every pair of faces whose boxes meet, merges coinciding vertices and
// edges and cuts the faces along all of it. Most of those pairs need no intersection, and a few of
// them (tangent neighbours, freeform pairs that only meet where both are dead) take most of the
// time, some for ever. The filler's list of pairs is therefore thinned out before it starts: face
// pairs that cannot cross go, and with them the edge pairs that only they would have asked for or
// whose cells do not touch.
// Weak spots: it never intersects a face with itself; callers limit its time; it refuses a single
// argument.
#include "rebuild/fuse.h"

#include <BOPAlgo_Builder.hxx>
#include <BOPAlgo_PaveFiller.hxx>
#include <BOPDS_DS.hxx>
#include <BOPDS_FaceInfo.hxx>
#include <BOPDS_IndexedMapOfPaveBlock.hxx>
#include <BOPDS_Iterator.hxx>
#include <BOPDS_PaveBlock.hxx>
#include <BOPDS_Tools.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Geom2d_Curve.hxx>
#include <Message_ProgressIndicator.hxx>
#include <ShapeFix_Edge.hxx>
#include <TColStd_MapOfInteger.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "exchange/hang_fence.h"
#include "rebuild/contact_cells.h"
#include "rebuild/inner_edges.h"
#include "rebuild/section_curves.h"

namespace phront::cad {
namespace {

// Of the size of all: intersection curves are good to a tenth of it.
constexpr double kDoubtful = 1e-6;
// s of processor time: most pairs take milliseconds, a few some seconds, others never end.
constexpr double kPairSeconds = 7;

/// Answers for edges by the faces that use them.
class PairFilter {
 public:
  PairFilter(const std::vector<TopoDS_Face>& faces, const std::vector<TopoDS_Shape>& cutters,
             const MayCross& mayCross)
      : mayCross_(mayCross), faces_(faces), cutters_(cutters) {}

  void index(const BOPDS_DS& ds) {
    TopTools_IndexedMapOfShape known;
    for (const TopoDS_Face& face : faces_) known.Add(face);
    owners_.resize(static_cast<std::size_t>(ds.NbSourceShapes()));
    for (std::size_t k = 0; k < cutters_.size(); ++k) {
      const int e = ds.Index(cutters_[k]);
      if (e >= 0)
        owners_[static_cast<std::size_t>(e)].push_back(static_cast<int>(faces_.size() + k));
    }
    for (int i = 0; i < ds.NbSourceShapes(); ++i) {
      if (ds.Shape(i).ShapeType() != TopAbs_FACE) continue;
      const int patch = known.FindIndex(ds.Shape(i)) - 1;
      owners_[static_cast<std::size_t>(i)].push_back(patch);
      for (TopExp_Explorer it(ds.Shape(i), TopAbs_EDGE); it.More(); it.Next()) {
        const int e = ds.Index(it.Current());
        if (e >= 0) owners_[static_cast<std::size_t>(e)].push_back(patch);
      }
    }
  }

  /// Some owner of one must be intersected with some owner of the other.
  bool wanted(int first, int second) {
    for (const int a : owners_[static_cast<std::size_t>(first)]) {
      for (const int b : owners_[static_cast<std::size_t>(second)]) {
        if (a == b || a < 0 || b < 0 || isCutter(a) || isCutter(b) ||
            cross(std::min(a, b), std::max(a, b)))
          return true;
      }
    }
    return false;
  }

 private:
  [[nodiscard]] bool isCutter(int owner) const { return owner >= static_cast<int>(faces_.size()); }

  bool cross(int a, int b) {
    const auto [it, isNew] = answers_.try_emplace({a, b}, false);
    if (isNew) it->second = mayCross_(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
    return it->second;
  }

  const MayCross& mayCross_;
  const std::vector<TopoDS_Face>& faces_;
  const std::vector<TopoDS_Shape>& cutters_;
  std::vector<std::vector<int>> owners_;  ///< patches (then cutters) that are or use a shape
  std::map<std::pair<int, int>, bool> answers_;
};

class ThinnedIterator : public BOPDS_Iterator {
 public:
  ThinnedIterator(PairFilter& filter, double fuzzy) : filter_(filter), cells_(fuzzy) {}

 protected:
  void Intersect(const Handle(IntTools_Context) & context, const Standard_Boolean checkBoxes,
                 const Standard_Real fuzzy) override {
    BOPDS_Iterator::Intersect(context, checkBoxes, fuzzy);
    filter_.index(*myDS);
    const int faceFace = BOPDS_Tools::TypeToInteger(TopAbs_FACE, TopAbs_FACE);
    const int edgeFace = BOPDS_Tools::TypeToInteger(TopAbs_EDGE, TopAbs_FACE);
    const int edgeEdge = BOPDS_Tools::TypeToInteger(TopAbs_EDGE, TopAbs_EDGE);
    for (const int type : {faceFace, edgeFace, edgeEdge}) {
      BOPDS_VectorOfPair& pairs = myLists(type);
      std::vector<BOPDS_Pair> kept;
      for (const BOPDS_Pair& pair : pairs) {
        int first = 0;
        int second = 0;
        pair.Indices(first, second);
        if (filter_.wanted(first, second) && mayTouch(first, second)) kept.push_back(pair);
      }
      pairs.Clear();
      for (const BOPDS_Pair& pair : kept) pairs.Append(pair);
    }
  }

 private:
  /// Edges against faces take most of the time, and the boxes of most such pairs only overlap.
  bool mayTouch(int first, int second) {
    const TopoDS_Shape& a = myDS->Shape(first);
    const TopoDS_Shape& b = myDS->Shape(second);
    const bool edgeA = a.ShapeType() == TopAbs_EDGE;
    const bool edgeB = b.ShapeType() == TopAbs_EDGE;
    if (edgeA && edgeB) return cells_.mayTouch(first, TopoDS::Edge(a), second, TopoDS::Edge(b));
    if (edgeA) return cells_.mayTouch(first, TopoDS::Edge(a), second, TopoDS::Face(b));
    if (edgeB) return cells_.mayTouch(second, TopoDS::Edge(b), first, TopoDS::Face(a));
    return true;
  }

  PairFilter& filter_;
  ContactCells cells_;
};

/// Asked once for every pair that is intersected; a pair that is told to break is as good as one
/// that failed. Told so between two stages the filler gives up.
class PairFence : public Message_ProgressIndicator {
 public:
  void rest() { fence_.rest(); }
  Standard_Boolean UserBreak() override { return fence_.enter() ? Standard_False : Standard_True; }

 protected:
  void Show(const Message_ProgressScope&, const Standard_Boolean) override {}

 private:
  HangFence fence_{kPairSeconds};
};

class ThinnedFiller : public BOPAlgo_PaveFiller {
 public:
  ThinnedFiller(PairFilter& filter, PairFence& fence) : filter_(filter), fence_(fence) {}

 protected:
  void Init(const Message_ProgressRange& range) override {
    BOPAlgo_PaveFiller::Init(range);
    if (HasErrors() || myIterator == nullptr) return;
    auto* thinned = new ThinnedIterator(filter_, myFuzzyValue);
    thinned->SetDS(myDS);
    thinned->SetRunParallel(Standard_False);
    thinned->Prepare(myContext, myUseOBB, myFuzzyValue);
    delete myIterator;
    myIterator = thinned;  // the base deletes it
  }

  /// Faces in no pair are not looked at again, even where an edge of theirs is merged or cut.
  void PerformFF(const Message_ProgressRange& range) override {
    TColStd_MapOfInteger faces;
    for (int i = 0; i < myDS->NbSourceShapes(); ++i) {
      if (myDS->Shape(i).ShapeType() == TopAbs_FACE) faces.Add(i);
    }
    myDS->UpdateFaceInfoOn(faces);
    myDS->UpdateFaceInfoIn(faces);
    BOPAlgo_PaveFiller::PerformFF(range);
    fence_.rest();
    Bnd_Box all;
    for (int i = 0; i < myDS->NbSourceShapes(); ++i) all.Add(myDS->ShapeInfo(i).Box());
    if (!all.IsVoid() && !all.IsOpen())
      settleSectionCurves(*myDS, myContext, kDoubtful * std::sqrt(all.SquareExtent()));
  }

 private:
  PairFilter& filter_;
  PairFence& fence_;
};

/// Merging edges now and then loses the parameter curve of one on a face, and one such edge makes
/// the builder throw for all faces.
void completeParameterCurves(BOPDS_DS& ds) {
  ShapeFix_Edge fix;
  for (int i = 0; i < ds.NbSourceShapes(); ++i) {
    if (ds.Shape(i).ShapeType() != TopAbs_FACE || !ds.HasFaceInfo(i)) continue;
    const TopoDS_Face& face = TopoDS::Face(ds.Shape(i));
    const BOPDS_FaceInfo& info = ds.FaceInfo(i);
    for (const BOPDS_IndexedMapOfPaveBlock* blocks :
         {&info.PaveBlocksOn(), &info.PaveBlocksIn(), &info.PaveBlocksSc()}) {
      for (int b = 1; b <= blocks->Extent(); ++b) {
        const int index = (*blocks)(b)->Edge();
        if (index < 0) continue;
        const TopoDS_Edge edge = TopoDS::Edge(ds.Shape(index).Oriented(TopAbs_FORWARD));
        double first = 0;
        double last = 0;
        if (BRep_Tool::CurveOnSurface(edge, face, first, last).IsNull()) {
          fix.FixAddPCurve(edge, face, Standard_False);
        }
      }
    }
  }
}

}  // namespace

Result<std::vector<TopoDS_Face>> splitFaces(const std::vector<TopoDS_Face>& faces, double fuzzy,
                                            const MayCross& mayCross,
                                            const std::vector<TopoDS_Shape>& cutters) {
  if (faces.size() + cutters.size() < 2) return faces;
  TopTools_ListOfShape arguments;
  for (const TopoDS_Face& face : faces) arguments.Append(face);
  for (const TopoDS_Shape& cutter : cutters) arguments.Append(cutter);

  const MayCross always = [](std::size_t, std::size_t) { return true; };
  PairFilter filter(faces, cutters, mayCross ? mayCross : always);
  const Handle(PairFence) fence = new PairFence;
  ThinnedFiller filler(filter, *fence);
  filler.SetArguments(arguments);
  filler.SetNonDestructive(Standard_True);
  filler.SetRunParallel(Standard_False);
  if (fuzzy > 0) filler.SetFuzzyValue(fuzzy);
  filler.Perform(fence->Start());
  fence->rest();
  if (filler.HasErrors()) return fail(ErrorCode::Failed, "the patches could not be intersected");

  completeParameterCurves(*filler.PDS());

  BOPAlgo_Builder builder;
  builder.SetArguments(arguments);
  builder.SetNonDestructive(Standard_True);
  builder.PerformWithFiller(filler);
  if (builder.HasErrors()) {
    return fail(ErrorCode::Failed, "the patches could not be cut along their intersections");
  }
  std::vector<TopoDS_Face> split;
  TopTools_MapOfShape seen;
  for (TopExp_Explorer it(builder.Shape(), TopAbs_FACE); it.More(); it.Next()) {
    if (seen.Add(it.Current())) split.push_back(withoutInnerEdges(TopoDS::Face(it.Current())));
  }
  return split;
}

}  // namespace phront::cad
