#include "rebuild/repair.h"

#include <BRepCheck_Analyzer.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <array>
#include <cmath>

#include "judge/read_back.h"
#include "patches/patch_tools.h"
#include "phront/cad/shape_occt.h"
#include "rebuild/assembly_bytes.h"
#include "rebuild/cells.h"
#include "rebuild/front_cuts.h"
#include "rebuild/fuse.h"

namespace phront::cad {
namespace {

/// Of |d|: how well lines that phi shows are met from both sides, as General Fuse's fuzzy value and
/// for sewing.
constexpr std::array kCutFuzzy{0.0, 1e-3};
constexpr double kCutSewing = 2e-3;
/// More lines than this are noise: the surfaces fold, and cutting takes long.
constexpr std::size_t kMostCuts = 80;

Result<Assembly> repaired(const std::vector<JudgedFace>& pieces, const RepairRequest& request,
                          const TrueDistance& phi) {
  const double size = std::abs(request.options.distance);
  const std::vector<TopoDS_Shape> cuts =
      frontCuts(pieces, true, request.options.distance, request.levelTolerance, phi);
  std::vector<TopoDS_Face> faces;
  for (const JudgedFace& piece : pieces) faces.push_back(piece.face);
  AssembleOptions options = request.options;
  options.sewTolerance = std::max(options.sewTolerance, kCutSewing * size);
  for (const double share : kCutFuzzy) {
    if (cuts.empty() || cuts.size() > kMostCuts) break;
    const auto never = [](std::size_t, std::size_t) { return false; };
    const Result<std::vector<TopoDS_Face>> split =
        splitFaces(faces, std::max(request.fuzzy, share * size), never, cuts);
    if (!split) continue;
    Assembly made = assembleSolids(request.judge(*split), options, phi);
    if (isSound(made, size)) return made;
  }
  return fail(ErrorCode::Failed, "the pieces do not close");
}

bool isSoundShape(const TopoDS_Shape& shape, double size) {
  if (countOpenEdges(shape) > 0 || !BRepCheck_Analyzer(shape).IsValid()) return false;
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next())
    if (!tessellates(TopoDS::Face(it.Current()), size)) return false;
  return true;
}

}  // namespace

bool isSound(const Assembly& assembly, double size) {
  if (assembly.shape.IsNull() || assembly.openEdges > 0) return false;
  if (isSoundShape(assembly.shape, size)) return true;
  // What reads a file makes its own parameter curves, also where these have gaps.
  Body body;
  body.shape = makeShape(assembly.shape);
  body.kind = BodyKind::Solid;
  const Result<std::optional<Model>> back = readBack({body});
  if (!back || !*back) return false;
  const std::vector<Body>& bodies = (*back)->bodies;
  return !bodies.empty() && std::all_of(bodies.begin(), bodies.end(), [&](const Body& b) {
    return b.kind == BodyKind::Solid && isSoundShape(occtShape(b.shape), size);
  });
}

Result<Assembly> repairPieces(const std::vector<JudgedFace>& pieces, const RepairRequest& request,
                              const TrueDistance& phi, const GuardLimits& limits) {
  const Result<std::string> bytes =
      runInChild("repairing the pieces", limits, [&]() -> Result<std::string> {
        const Result<Assembly> made = repaired(pieces, request, phi);
        if (!made) return tl::unexpected(made.error());
        return bytesOfAssembly(*made);
      });
  if (!bytes) return tl::unexpected(bytes.error());
  Result<Assembly> assembly = assemblyOfBytes(*bytes);
  if (!assembly) return assembly;
  assembly->way = "pieces cut by phi";
  return assembly;
}

}  // namespace phront::cad
