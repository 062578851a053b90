#include "phront/cad/offset_surfaces.h"

#include <fmt/format.h>

#include <BRep_Builder.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "deadline.h"
#include "exchange/guard.h"
#include "exchange/shape_bytes.h"
#include "phront/cad/shape_occt.h"
#include "request.h"
#include "surfaces/trimmed_offset.h"
#include "tessellate/body_distance.h"

namespace phront::cad {
namespace {

constexpr double kTessellateShare = 0.4;  // of the time left
constexpr double kMostTessellateSeconds = 45;
constexpr double kMostFaceSeconds = 30;
constexpr double kLeastFaceSeconds = 2;
constexpr double kFaceMemoryMiB = 4096;
constexpr std::size_t kHeader = 8;  // digits of the size of the report before the shape

TopoDS_Compound compoundOf(const std::vector<TopoDS_Face>& faces) {
  const BRep_Builder builder;
  TopoDS_Compound compound;
  builder.MakeCompound(compound);
  for (const TopoDS_Face& face : faces) builder.Add(compound, face);
  return compound;
}

std::string packed(const TrimmedOffset& offset) {
  const FaceOffset& r = offset.report;
  const std::string header = nlohmann::json{
      {"kind", static_cast<int>(r.kind)},
      {"type", static_cast<int>(r.type)},
      {"whole", r.whole},
      {"input_poles", r.inputPoles},
      {"poles", r.poles},
      {"fit_error", r.fitError},
      {"deviation", r.deviation},
      {"trouble", r.trouble}}.dump();
  return fmt::format("{:08}", header.size()) + header + bytesOfShape(compoundOf(offset.faces));
}

Result<TrimmedOffset> unpacked(const std::string& bytes) {
  const std::size_t size = std::stoul(bytes.substr(0, kHeader));
  const auto header = nlohmann::json::parse(bytes.substr(kHeader, size));
  TrimmedOffset offset;
  FaceOffset& r = offset.report;
  r.kind = static_cast<FaceOffsetKind>(header["kind"].get<int>());
  r.type = static_cast<SurfaceType>(header["type"].get<int>());
  r.whole = header["whole"];
  r.inputPoles = header["input_poles"];
  r.poles = header["poles"];
  r.fitError = header["fit_error"];
  r.deviation = header["deviation"];
  r.trouble = header["trouble"];
  const Result<TopoDS_Shape> shape = shapeOfBytes(std::string_view(bytes).substr(kHeader + size));
  if (!shape) return tl::unexpected(shape.error());
  for (TopExp_Explorer it(*shape, TopAbs_FACE); it.More(); it.Next())
    offset.faces.push_back(TopoDS::Face(it.Current()));
  r.surfaces = static_cast<int>(offset.faces.size());
  return offset;
}

TrimmedOffset guarded(const TopoDS_Face& face, bool solid, const SurfacesOptions& options,
                      const TrueDistance& phi, double seconds) {
  const Result<std::string> bytes =
      runInChild("offsetting a face", {seconds, kFaceMemoryMiB}, [&]() -> Result<std::string> {
        return packed(offsetTrimmedFace(face, solid, options.distance, *options.tolerance, phi));
      });
  if (bytes) {
    if (Result<TrimmedOffset> offset = unpacked(*bytes)) return std::move(*offset);
  }
  TrimmedOffset failed;
  failed.report.trouble = bytes ? "its bytes were not understood" : bytes.error().message;
  return failed;
}

/// Threads that only wait for their children, each for the next face.
Result<std::vector<TrimmedOffset>> offsetFaces(const std::vector<TopoDS_Face>& faces, bool solid,
                                               const SurfacesOptions& options,
                                               const TrueDistance& phi, const Deadline& deadline,
                                               const Progress& progress) {
  std::vector<TrimmedOffset> offsets(faces.size());
  std::atomic<std::size_t> next{0};
  std::atomic<std::size_t> done{0};
  std::atomic<bool> stop{false};
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t wanted =
      options.threads > 0 ? static_cast<std::size_t>(options.threads) : cores;
  const auto work = [&] {
    for (std::size_t i = next++; i < faces.size() && !stop; i = next++) {
      const double seconds = deadline.forStep(1, 0, kMostFaceSeconds);
      if (seconds < kLeastFaceSeconds)
        offsets[i].report.trouble = "no time was left for it";
      else
        offsets[i] = guarded(faces[i], solid, options, phi, seconds);
      ++done;
    }
  };
  std::vector<std::thread> workers;
  for (std::size_t k = 0; k < std::min(wanted, faces.size()); ++k) workers.emplace_back(work);
  while (done < faces.size() && !stop) {
    if (!progress.report(static_cast<double>(done) / static_cast<double>(faces.size())))
      stop = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  for (std::thread& worker : workers) worker.join();
  if (stop) return fail(ErrorCode::Cancelled, "the offset was cancelled");
  return offsets;
}

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
        offsetFaces(faces, body.kind == BodyKind::Solid, options, *phi, ownTime, part);
    if (!offsets) return tl::unexpected(offsets.error());
    BodySurfaces report{body.name, {}};
    Body made;
    made.kind = BodyKind::Sheet;
    made.name = body.name;
    std::vector<TopoDS_Face> all;
    for (std::size_t f = 0; f < offsets->size(); ++f) {
      const TrimmedOffset& offset = (*offsets)[f];
      report.faces.push_back(offset.report);
      for (const TopoDS_Face& face : offset.faces) {
        all.push_back(face);
        made.faceNames.push_back(f < body.faceNames.size() ? body.faceNames[f] : std::string());
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
