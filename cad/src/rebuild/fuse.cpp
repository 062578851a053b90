// BOPAlgo_Builder intersects every pair of faces, merges coinciding vertices and edges and cuts the
// faces along all of it. Weak spots: it never intersects a face with itself; on some freeform pairs
// it takes for ever, so callers limit its time; it refuses a single argument.
#include "rebuild/fuse.h"

#include <BOPAlgo_Builder.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS.hxx>

namespace phront::cad {

Result<std::vector<TopoDS_Face>> splitFaces(const std::vector<TopoDS_Face>& faces, double fuzzy) {
  if (faces.size() < 2) return faces;
  BOPAlgo_Builder builder;
  TopTools_ListOfShape arguments;
  for (const TopoDS_Face& face : faces) arguments.Append(face);
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
  return split;
}

}  // namespace phront::cad
