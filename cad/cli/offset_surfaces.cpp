#include "offset_surfaces.h"

#include <fmt/format.h>

#include "phront/cad/exchange.h"
#include "phront/cad/offset_shape.h"

namespace phront::cli {
namespace {

using cad::FaceOffset;
using cad::FaceOffsetKind;

const char* wordFor(FaceOffsetKind kind) {
  switch (kind) {
    case FaceOffsetKind::Exact:
      return "exact";
    case FaceOffsetKind::Fitted:
      return "fitted";
    case FaceOffsetKind::Vanished:
      return "vanished";
    case FaceOffsetKind::Failed:
      break;
  }
  return "failed";
}

nlohmann::json jsonOf(const cad::SurfacesResult& result) {
  nlohmann::json bodies = nlohmann::json::array();
  for (const cad::BodySurfaces& body : result.bodies) {
    nlohmann::json faces = nlohmann::json::array();
    for (const FaceOffset& face : body.faces)
      faces.push_back({{"kind", wordFor(face.kind)},
                       {"type", cli::wordFor(face.type)},
                       {"surfaces", face.surfaces},
                       {"whole", face.whole},
                       {"input_poles", face.inputPoles},
                       {"poles", face.poles},
                       {"fit_error_mm", face.fitError},
                       {"deviation_mm", face.deviation},
                       {"trouble", face.trouble}});
    bodies.push_back({{"name", body.name}, {"faces", faces}});
  }
  return {{"distance_mm", result.options.distance},
          {"tolerance_mm", result.options.tolerance.value_or(0)},
          {"exact", result.count(FaceOffsetKind::Exact)},
          {"fitted", result.count(FaceOffsetKind::Fitted)},
          {"vanished", result.count(FaceOffsetKind::Vanished)},
          {"failed", result.count(FaceOffsetKind::Failed)},
          {"deviation_mm", result.deviation()},
          {"bodies", bodies},
          {"warnings", result.warnings}};
}

std::string summaryOf(const cad::SurfacesResult& result) {
  int faces = 0;
  int surfaces = 0;
  int inputPoles = 0;
  int poles = 0;
  for (const cad::BodySurfaces& body : result.bodies) {
    for (const FaceOffset& face : body.faces) {
      ++faces;
      surfaces += face.surfaces;
      if (face.kind != FaceOffsetKind::Fitted) continue;
      inputPoles += face.inputPoles;
      poles += face.poles;
    }
  }
  std::string text = fmt::format("{} trimmed surfaces from {} faces: {} exact", surfaces, faces,
                                 result.count(FaceOffsetKind::Exact));
  if (const int fitted = result.count(FaceOffsetKind::Fitted); fitted > 0)
    text += fmt::format(", {} fitted ({} poles, the faces' had {})", fitted, poles, inputPoles);
  if (const int vanished = result.count(FaceOffsetKind::Vanished); vanished > 0)
    text += fmt::format(", {} faces vanished", vanished);
  return text + fmt::format("; measured deviation at most {:.3g} mm ({:.2g} % of d)",
                            result.deviation(),
                            100 * result.deviation() / std::abs(result.options.distance));
}

/// Of the first face that failed or misses the tolerance; empty when there is none.
std::string troubleOf(const cad::SurfacesResult& result) {
  for (const cad::BodySurfaces& body : result.bodies) {
    for (std::size_t f = 0; f < body.faces.size(); ++f) {
      const FaceOffset& face = body.faces[f];
      const std::string which =
          fmt::format("face {}{}", f + 1, body.name.empty() ? "" : " of body '" + body.name + "'");
      if (face.kind == FaceOffsetKind::Failed)
        return fmt::format("{} has no offset: {}", which, face.trouble);
      if (face.deviation > result.options.tolerance.value_or(0))
        return fmt::format("the offset of {} deviates by {:.3g} mm", which, face.deviation);
    }
  }
  return {};
}

void sayFaces(const cad::SurfacesResult& result) {
  for (const cad::BodySurfaces& body : result.bodies) {
    for (std::size_t f = 0; f < body.faces.size(); ++f) {
      const FaceOffset& face = body.faces[f];
      fmt::print(stderr,
                 "  face {:<5}{:<11}{:<9} {} surface(s), {} poles, deviation {:.3g} mm {}\n", f + 1,
                 cli::wordFor(face.type), wordFor(face.kind), face.surfaces, face.poles, face.deviation,
                 face.trouble);
    }
  }
}

}  // namespace

int offsetSurfacesFile(const cad::Model& model, const std::filesystem::path& in,
                       const std::filesystem::path& out, const cad::SurfacesOptions& options,
                       const CommonOptions& common) {
  const Result<cad::SurfacesResult> result =
      cad::offsetSurfaces(model, options, makeProgress(common));
  endProgress(common);
  if (!result) return reportError(result.error());
  if (interrupted()) return kInterrupted;
  if (common.verbose) sayFaces(*result);
  if (const Result<void> ok = writeReport(jsonOf(*result), common); !ok)
    return reportError(ok.error());
  const std::string trouble = troubleOf(*result);
  if (result->model.bodies.empty()) {
    if (!trouble.empty()) return reportError({ErrorCode::Failed, trouble, {}});
    if (!common.quiet) fmt::print(stderr, "no face has a part on the front: there is no offset\n");
    return kDone;
  }
  const std::filesystem::path path = trouble.empty() || common.keep ? out : cad::rejectedPath(out);
  if (const Result<void> ok = cad::writeModel(result->model, path); !ok)
    return reportError(ok.error());
  if (const Result<void> ok =
          drawModels(model, in.filename().string(), result->model,
                     fmt::format("offset surfaces {:+g} mm", result->options.distance), common);
      !ok)
    return reportError(ok.error());
  if (!trouble.empty())
    return reportError({ErrorCode::OutOfTolerance,
                        fmt::format("not every face has an offset within the tolerance, the others "
                                    "were written to {}: {}",
                                    path.string(), trouble),
                        {}});
  if (!common.quiet) fmt::print(stderr, "{}: {}\n", path.string(), summaryOf(*result));
  return kDone;
}

}  // namespace phront::cli
