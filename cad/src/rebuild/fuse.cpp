// BOPAlgo_Builder intersects every pair of faces, merges coinciding vertices and edges and cuts the
// faces along all of it. A patch that is on the offset all over is crossed by nothing: whatever
// crossed it would come nearer to the input than |d| on one side and be farther on the other, and
// no patch is farther. Such patches can be set aside, which saves most of the time on convex parts.
// Weak spots: it never intersects a face with itself; on some freeform pairs
// it takes for ever, so callers limit its time; it refuses a single argument.
#include "rebuild/fuse.h"

#include <BOPAlgo_Builder.hxx>
#include <BRepTools_ReShape.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <ShapeFix_Edge.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>

namespace phront::cad {
namespace {

/// Edges and vertices that the fuse replaced, in the settled faces too. Merged edges may come from
/// another face and lack a parameter curve on this one.
std::vector<TopoDS_Face> withReplacedEdges(const std::vector<TopoDS_Face>& settled,
                                           BOPAlgo_Builder& fuse) {
  const Handle(BRepTools_ReShape) reshape = new BRepTools_ReShape;
  TopTools_IndexedMapOfShape parts;
  for (const TopoDS_Face& face : settled) {
    TopExp::MapShapes(face, TopAbs_VERTEX, parts);
    TopExp::MapShapes(face, TopAbs_EDGE, parts);
  }
  for (int i = 1; i <= parts.Extent(); ++i) {
    const TopTools_ListOfShape& images = fuse.Modified(parts(i));
    if (images.IsEmpty()) continue;
    if (images.Extent() == 1) {
      reshape->Replace(parts(i), images.First());
      continue;
    }
    const BRep_Builder builder;
    TopoDS_Compound pieces;
    builder.MakeCompound(pieces);
    for (const TopoDS_Shape& image : images) builder.Add(pieces, image);
    reshape->Replace(parts(i), pieces);
  }
  std::vector<TopoDS_Face> result;
  for (const TopoDS_Face& face : settled) {
    const TopoDS_Face renewed = TopoDS::Face(reshape->Apply(face));
    ShapeFix_Edge fix;
    for (TopExp_Explorer it(renewed, TopAbs_EDGE); it.More(); it.Next()) {
      const TopoDS_Edge edge = TopoDS::Edge(it.Current());
      double first = 0;
      double last = 0;
      if (BRep_Tool::CurveOnSurface(edge, renewed, first, last).IsNull()) {
        fix.FixAddPCurve(edge, renewed, Standard_False);
      }
    }
    result.push_back(renewed);
  }
  return result;
}

}  // namespace

Result<std::vector<TopoDS_Face>> splitFaces(const std::vector<TopoDS_Face>& faces, double fuzzy) {
  return splitFaces(faces, {}, fuzzy);
}

Result<std::vector<TopoDS_Face>> splitFaces(const std::vector<TopoDS_Face>& faces,
                                            const std::vector<TopoDS_Face>& settled, double fuzzy) {
  TopTools_ListOfShape arguments;
  TopTools_IndexedMapOfShape taken;
  for (const TopoDS_Face& face : faces) {
    arguments.Append(face);
    TopExp::MapShapes(face, TopAbs_EDGE, taken);
  }
  if (!faces.empty()) {
    for (const TopoDS_Face& face : settled) {
      for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
        if (taken.Contains(it.Current()) || BRep_Tool::Degenerated(TopoDS::Edge(it.Current()))) {
          continue;
        }
        taken.Add(it.Current());
        arguments.Append(it.Current());
      }
    }
  }
  if (arguments.Extent() < 2) {
    std::vector<TopoDS_Face> all = faces;
    all.insert(all.end(), settled.begin(), settled.end());
    return all;
  }
  BOPAlgo_Builder builder;
  builder.SetArguments(arguments);
  builder.SetNonDestructive(Standard_True);
  builder.SetRunParallel(Standard_False);
  if (fuzzy > 0) builder.SetFuzzyValue(fuzzy);
  builder.Perform();
  if (builder.HasErrors()) {
    return fail(ErrorCode::Failed, "the patches could not be intersected");
  }
  std::vector<TopoDS_Face> split;
  TopTools_MapOfShape seen;
  for (TopExp_Explorer it(builder.Shape(), TopAbs_FACE); it.More(); it.Next()) {
    if (seen.Add(it.Current())) split.push_back(TopoDS::Face(it.Current()));
  }
  if (!settled.empty()) {
    const std::vector<TopoDS_Face> renewed = withReplacedEdges(settled, builder);
    split.insert(split.end(), renewed.begin(), renewed.end());
  }
  return split;
}

}  // namespace phront::cad
