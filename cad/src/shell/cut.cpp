#include "shell/cut.h"

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_Copy.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ListOfShape.hxx>

#include "exchange/guard.h"
#include "exchange/shape_bytes.h"

namespace phront::cad {
namespace {

constexpr double kMemoryMiB = 3000;

}  // namespace

Result<TopoDS_Shape> cutSolid(const TopoDS_Shape& from, const std::vector<TopoDS_Shape>& tools,
                              double fuzzy, double seconds) {
  const Result<std::string> bytes =
      runInChild("cutting solids", {seconds, kMemoryMiB}, [&]() -> Result<std::string> {
        BRepAlgoAPI_Cut cut;
        TopTools_ListOfShape arguments;
        arguments.Append(BRepBuilderAPI_Copy(from).Shape());
        TopTools_ListOfShape cutters;
        for (const TopoDS_Shape& tool : tools) cutters.Append(BRepBuilderAPI_Copy(tool).Shape());
        cut.SetArguments(arguments);
        cut.SetTools(cutters);
        cut.SetFuzzyValue(fuzzy);
        cut.Build();
        if (!cut.IsDone() || cut.HasErrors())
          return fail(ErrorCode::Failed, "OpenCASCADE cannot cut the solids with one another");
        if (!TopExp_Explorer(cut.Shape(), TopAbs_SOLID).More()) return std::string();
        return bytesOfShape(cut.Shape());
      });
  if (!bytes) return tl::unexpected(bytes.error());
  if (bytes->empty()) return TopoDS_Shape();
  return shapeOfBytes(*bytes);
}

}  // namespace phront::cad
