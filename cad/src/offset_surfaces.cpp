#include "phront/cad/offset_surfaces.h"

#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>

#include "deadline.h"
#include "phront/cad/shape_occt.h"
#include "request.h"
#include "surfaces/face_offsets.h"
#include "tessellate/body_distance.h"

namespace phront::cad {
namespace {

constexpr double kTessellateShare = 0.4;  // of the time left
constexpr double kMostTessellateSeconds = 45;
}  // namespace

int SurfacesResult::count(FaceOffsetKind kind) const {
  int sum = 0;
  for (const BodySurfaces& body : bodies)
    sum += static_cast<int>(std::count_if(body.faces.begin(), body.faces.end(),
                                          [&](const FaceOffset& f) { return f.kind == kind; }));
  return sum;
}

double SurfacesResult::deviation() const {
  double most = 0;
  for (const BodySurfaces& body : bodies)
    for (const FaceOffset& face : body.faces) most = std::max(most, face.deviation);
  return most;
}

Result<SurfacesResult> offsetSurfaces(const Model& model, const SurfacesOptions& requested,
                                      const Progress& progress) {
  const Result<double> tolerance =
      checkedTolerance(model, requested.distance, requested.tolerance, requested.timeLimit);
  if (!tolerance) return tl::unexpected(tolerance.error());
  SurfacesOptions options = requested;
  options.tolerance = *tolerance;
  SurfacesResult result;
  result.options = options;
  result.warnings = model.warnings;
  result.model.unit = model.unit;
  result.model.unitInMm = model.unitInMm;
  const Deadline deadline(options.timeLimit);
  const double count = static_cast<double>(model.bodies.size());
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const Body& body = model.bodies[b];
    const Progress part =
        progress.part(static_cast<double>(b) / count, static_cast<double>(b + 1) / count, "faces");
    if (!part.report(0)) return fail(ErrorCode::Cancelled, "the offset was cancelled");
    const Deadline ownTime(deadline.left() / static_cast<double>(model.bodies.size() - b));
    const Result<TrueDistance> phi = distanceOf(
        body, options.distance, ownTime.forStep(kTessellateShare, 1, kMostTessellateSeconds));
    if (!phi) return tl::unexpected(phi.error());
    TopTools_IndexedMapOfShape map;
    TopExp::MapShapes(occtShape(body.shape), TopAbs_FACE, map);
    std::vector<TopoDS_Face> faces;
    for (int f = 1; f <= map.Extent(); ++f) faces.push_back(TopoDS::Face(map(f)));
    Result<std::vector<TrimmedOffset>> offsets =
        offsetFaces(faces, {body.kind == BodyKind::Solid, options.distance, *options.tolerance},
                    options.threads, *phi, ownTime, part);
    if (!offsets) return tl::unexpected(offsets.error());
    BodySurfaces report{body.name, {}};
    Body made;
    made.kind = BodyKind::Sheet;
    made.name = body.name;
    made.colour = body.colour;
    std::vector<TopoDS_Face> all;
    for (std::size_t f = 0; f < offsets->size(); ++f) {
      const TrimmedOffset& offset = (*offsets)[f];
      report.faces.push_back(offset.report);
      for (const TopoDS_Face& face : offset.faces) {
        all.push_back(face);
        made.faceNames.push_back(f < body.faceNames.size() ? body.faceNames[f] : std::string());
        if (f < body.faceColours.size()) made.faceColours.push_back(body.faceColours[f]);
      }
    }
    result.bodies.push_back(std::move(report));
    if (all.empty()) continue;
    made.shape = makeShape(compoundOf(all));
    result.model.bodies.push_back(std::move(made));
  }
  return result;
}

}  // namespace phront::cad
