#include "rebuild/file_faults.h"

#include <BRepCheck_Analyzer.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Shell.hxx>
#include <optional>
#include <set>

#include "judge/read_back.h"
#include "judge/widest_gap.h"
#include "phront/cad/shape_occt.h"
#include "rebuild/cells.h"
#include "rebuild/select.h"

namespace phront::cad {
namespace {

Vec3 pointOn(const TopoDS_Face& face) {
  const std::vector<FaceSample> samples = interiorSamples(face);
  const TopExp_Explorer corner(face, TopAbs_VERTEX);
  gp_Pnt p;
  if (!samples.empty())
    p = samples.front().point;
  else if (corner.More())
    p = BRep_Tool::Pnt(TopoDS::Vertex(corner.Current()));
  return {p.X(), p.Y(), p.Z()};
}

}  // namespace

std::vector<Vec3> faultsInFile(const std::vector<TopoDS_Face>& faces, double gap,
                               const MeshSize& size) {
  const BRep_Builder builder;
  TopoDS_Shell shell;
  builder.MakeShell(shell);
  for (const TopoDS_Face& face : inReadingOrder(faces)) builder.Add(shell, face);
  Body body;
  body.shape = makeShape(shell);
  body.kind = BodyKind::Sheet;
  const Result<std::optional<Model>> back = readBack({body});
  if (!back || !*back) return {};
  TopoDS_Compound all;
  builder.MakeCompound(all);
  for (const Body& found : (*back)->bodies) builder.Add(all, occtShape(found.shape));
  const std::vector<int> missing = facesWithoutTriangles(all, size);
  const std::set<int> untessellated(missing.begin(), missing.end());
  std::vector<Vec3> faults;
  int number = 0;
  for (TopExp_Explorer it(all, TopAbs_FACE); it.More(); it.Next(), ++number) {
    const TopoDS_Face& face = TopoDS::Face(it.Current());
    if (untessellated.contains(number) || !BRepCheck_Analyzer(face).IsValid() ||
        !gapsOf(face, gap).empty())
      faults.push_back(pointOn(face));
  }
  return faults;
}

}  // namespace phront::cad
