// General Fuse cannot cut a face that crosses itself, as the offset of a blade does where |d|
// exceeds its radius of curvature. A sheet needs no closed set of pieces, so each face can be cut
// alone, along the lines where phi says that the front ends.
#include "rebuild/sheet_stage.h"

#include <fmt/format.h>

#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>

#include "exchange/guard.h"
#include "exchange/shape_bytes.h"
#include "judge/read_back.h"
#include "phront/cad/shape_occt.h"
#include "rebuild/attempt_runner.h"
#include "surfaces/face_offsets.h"

namespace phront::cad {
namespace {

constexpr double kFacesShare = 0.8;   // of the time left
constexpr double kTrimShare = 0.9;    // of the tolerance, for each face
constexpr double kSewingShare = 0.1;  // of the tolerance
constexpr double kSewingSeconds = 10;
constexpr double kSewingMemoryMiB = 2000;
constexpr double kLeastCheckSeconds = 5;
constexpr double kMostCheckSeconds = 40;

/// Sewn if that is valid, else as they are.
TopoDS_Shape sewn(const std::vector<TopoDS_Face>& faces, double tolerance) {
  const TopoDS_Shape apart = compoundOf(faces);
  const Result<std::string> bytes =
      runInChild("sewing faces", {kSewingSeconds, kSewingMemoryMiB}, [&]() -> Result<std::string> {
        BRepBuilderAPI_Sewing sewing(tolerance);
        for (const TopoDS_Face& face : faces) sewing.Add(face);
        sewing.Perform();
        const TopoDS_Shape& whole = sewing.SewedShape();
        if (whole.IsNull() || !BRepCheck_Analyzer(whole).IsValid())
          return fail(ErrorCode::Failed, "the sewn sheet is not valid");
        return bytesOfShape(whole);
      });
  if (!bytes) return apart;
  const Result<TopoDS_Shape> shape = shapeOfBytes(*bytes);
  return shape ? *shape : apart;
}

}  // namespace

Result<SheetAttempt> sheetOfFaces(const Body& healed, const OffsetOptions& options,
                                  const TrueDistance& phi, const BodyCheck& check,
                                  const Deadline& deadline, const Progress& progress) {
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(occtShape(healed.shape), TopAbs_FACE, map);
  std::vector<TopoDS_Face> faces;
  for (int f = 1; f <= map.Extent(); ++f) faces.push_back(TopoDS::Face(map(f)));
  const TrimRequest request{false, options.distance, kTrimShare * *options.tolerance};
  const Result<std::vector<TrimmedOffset>> offsets = offsetFaces(
      faces, request, options.threads, phi, Deadline(kFacesShare * deadline.left()), progress);
  if (!offsets) return tl::unexpected(offsets.error());
  SheetAttempt made;
  std::vector<TopoDS_Face> all;
  for (std::size_t f = 0; f < offsets->size(); ++f) {
    const TrimmedOffset& offset = (*offsets)[f];
    if (offset.report.kind == FaceOffsetKind::Failed) {
      made.check = failedCheck(fmt::format("the offset of face {} could not be trimmed: {}", f + 1,
                                           offset.report.trouble));
      return made;
    }
    const bool exact = offset.report.kind == FaceOffsetKind::Exact;
    (exact ? made.exactFaces : made.fittedFaces) += offset.report.surfaces;
    all.insert(all.end(), offset.faces.begin(), offset.faces.end());
  }
  if (!all.empty()) {
    const double tolerance = kSewingShare * *options.tolerance;
    made.bodies = bodiesOf(sewn(all, tolerance), BodyKind::Sheet, healed.name);
    Model out;
    out.bodies = made.bodies;
    const double diagonal = phi.surface().box().diagonal().norm();
    // Sewing moves edges; what does not survive a file is better left apart.
    if (!exchangeFault(out, usualMeshSize({diagonal, options.distance, false})).empty())
      made.bodies = bodiesOf(compoundOf(all), BodyKind::Sheet, healed.name);
  }
  made.check = check.inMemory(made.bodies, options,
                              deadline.forStep(1, kLeastCheckSeconds, kMostCheckSeconds));
  return made;
}

}  // namespace phront::cad
