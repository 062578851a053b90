// The bytes are read and looked at here, in the parent: that code is ours. OpenCASCADE sees the
// file only in a guarded child, which inherits the bytes by fork and answers with the finished
// model.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "exchange/file_text.h"
#include "exchange/guard.h"
#include "exchange/load_shapes.h"
#include "exchange/make_bodies.h"
#include "exchange/model_bytes.h"
#include "exchange/step_scan.h"
#include "phront/cad/exchange.h"

namespace phront::cad {
namespace {

tl::unexpected<Error> unreadable(const std::filesystem::path& path, const std::string& why) {
  return fail(ErrorCode::UnreadableInput,
              fmt::format("reading {}: {}", path.filename().string(), why), path.string());
}

Result<Loaded> load(const std::filesystem::path& path, const FileText& file, const StepScan& scan) {
  switch (file.format) {
    case ShapeFormat::Step:
      return loadStep(file, scan);
    case ShapeFormat::Iges:
      return loadIges(path);
    case ShapeFormat::Brep:
      return loadBrep(file);
  }
  return fail(ErrorCode::UnreadableInput, "its format is not known");
}

// Faults of OpenCASCADE mean a damaged file here; what the scan saw may say where.
Error explain(Error error, const std::filesystem::path& path, const StepScan& scan) {
  if (error.code == ErrorCode::Failed) {
    error.code = ErrorCode::UnreadableInput;
    error.message += "; the file is probably damaged";
  }
  if (!scan.suspicion.empty()) error.message += " (" + scan.suspicion + ")";
  if (error.where.empty()) error.where = path.string();
  return error;
}

Result<void> validate(const ReadOptions& options) {
  const auto positive = [](double value) { return value > 0 && std::isfinite(value); };
  const char* bad = !positive(options.timeLimit)                  ? "timeLimit"
                    : !positive(options.memoryLimit)              ? "memoryLimit"
                    : !positive(options.maxExtent)                ? "maxExtent"
                    : !positive(options.sewTolerance.value_or(1)) ? "sewTolerance"
                                                                  : nullptr;
  if (!bad) return {};
  return fail(ErrorCode::InvalidArgument, fmt::format("ReadOptions::{} must be positive", bad));
}

}  // namespace

Result<ShapeFormat> shapeFormatOf(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".step" || extension == ".stp") return ShapeFormat::Step;
  if (extension == ".iges" || extension == ".igs") return ShapeFormat::Iges;
  if (extension == ".brep" || extension == ".brp") return ShapeFormat::Brep;
  return fail(ErrorCode::InvalidArgument,
              fmt::format("{}: the extension must be one of .step .stp .iges .igs .brep .brp",
                          path.filename().string()),
              path.string());
}

Result<Model> readModel(const std::filesystem::path& path, const ReadOptions& options) {
  if (const auto valid = validate(options); !valid) return tl::unexpected<Error>(valid.error());
  const auto maxBytes = static_cast<std::size_t>(std::min(options.memoryLimit, 1e6) * (1 << 20));
  auto file = loadFile(path, maxBytes);
  if (!file) return tl::unexpected<Error>(file.error());
  StepScan scan;
  std::optional<std::string> defect;
  if (file->format == ShapeFormat::Step) {
    scan = scanStep(file->bytes);
    if (!scan.defect.empty()) defect = scan.defect;
  } else if (file->format == ShapeFormat::Iges) {
    defect = igesDefect(file->bytes);
  } else if (!file->binaryBrep) {
    defect = brepDefect(file->bytes);
  }
  if (defect) return unreadable(path, *defect);

  const std::string what = "reading " + path.filename().string();
  const GuardLimits limits{.seconds = options.timeLimit, .memoryMiB = options.memoryLimit};
  const auto bytes = runInChild(what, limits, [&]() -> Result<std::string> {
    auto loaded = load(path, *file, scan);
    if (!loaded) return unreadable(path, loaded.error().message);
    const auto model = makeBodies(std::move(*loaded), options);
    if (!model) return unreadable(path, model.error().message);
    return bytesOfModel(*model);
  });
  if (!bytes) return tl::unexpected<Error>(explain(bytes.error(), path, scan));
  auto model = modelOfBytes(*bytes);
  if (!model) return model;
  std::vector<std::string> warnings = file->warnings;
  warnings.insert(warnings.end(), scan.warnings.begin(), scan.warnings.end());
  warnings.insert(warnings.end(), model->warnings.begin(), model->warnings.end());
  model->warnings = std::move(warnings);
  return model;
}

}  // namespace phront::cad
