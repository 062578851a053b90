#include "surfaces/face_offsets.h"

#include <fmt/format.h>

#include <BRep_Builder.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <atomic>
#include <nlohmann/json.hpp>
#include <thread>

#include "exchange/guard.h"
#include "exchange/shape_bytes.h"

namespace phront::cad {
namespace {

constexpr double kMostFaceSeconds = 60;
constexpr double kLeastFaceSeconds = 2;
constexpr double kFaceMemoryMiB = 4096;
constexpr std::size_t kHeader = 8;  // digits of the size of the report before the shape

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

TrimmedOffset guarded(const TopoDS_Face& face, const TrimRequest& request, const TrueDistance& phi,
                      double seconds) {
  const Result<std::string> bytes = runInChild(
      "offsetting a face", {seconds, kFaceMemoryMiB},
      [&]() -> Result<std::string> { return packed(offsetTrimmedFace(face, request, phi)); });
  if (bytes) {
    if (Result<TrimmedOffset> offset = unpacked(*bytes)) return std::move(*offset);
  }
  TrimmedOffset failed;
  failed.report.trouble = bytes ? "its bytes were not understood" : bytes.error().message;
  return failed;
}

}  // namespace

TopoDS_Compound compoundOf(const std::vector<TopoDS_Face>& faces) {
  const BRep_Builder builder;
  TopoDS_Compound compound;
  builder.MakeCompound(compound);
  for (const TopoDS_Face& face : faces) builder.Add(compound, face);
  return compound;
}

// Threads that only wait for their children, each for the next face.
Result<std::vector<TrimmedOffset>> offsetFaces(const std::vector<TopoDS_Face>& faces,
                                               const TrimRequest& request, int threads,
                                               const TrueDistance& phi, const Deadline& deadline,
                                               const Progress& progress) {
  std::vector<TrimmedOffset> offsets(faces.size());
  std::atomic<std::size_t> next{0};
  std::atomic<std::size_t> done{0};
  std::atomic<bool> stop{false};
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t wanted = threads > 0 ? static_cast<std::size_t>(threads) : cores;
  const auto work = [&] {
    for (std::size_t i = next++; i < faces.size() && !stop; i = next++) {
      const double seconds = deadline.forStep(1, 0, kMostFaceSeconds);
      if (seconds < kLeastFaceSeconds)
        offsets[i].report.trouble = "no time was left for it";
      else
        offsets[i] = guarded(faces[i], request, phi, seconds);
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

}  // namespace phront::cad
