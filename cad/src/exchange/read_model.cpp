// The bytes are read and looked at here, in the parent: that code is ours. OpenCASCADE sees the
// file only in a guarded child, which inherits the bytes by fork and answers with the finished
// model.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "exchange/cad_file.h"
#include "exchange/guard.h"
#include "exchange/make_bodies.h"
#include "exchange/model_bytes.h"
#include "phront/cad/exchange.h"

namespace phront::cad {
namespace {

// The time limit is meant for files up to this size. STEP files of planar facets, the slowest kind,
// take half a second for each MB.
constexpr double kOrdinaryMegabytes = 20;

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
  const auto file = openCadFile(path, options.memoryLimit);
  if (!file) return tl::unexpected<Error>(file.error());
  const std::string what = "reading " + path.filename().string();
  std::error_code unknown;
  const std::uintmax_t size = std::filesystem::file_size(path, unknown);
  const double megabytes = unknown ? 0 : 1e-6 * static_cast<double>(size);
  const double seconds = options.timeLimit * std::max(1.0, megabytes / kOrdinaryMegabytes);
  const GuardLimits limits{.seconds = seconds, .memoryMiB = options.memoryLimit};
  const auto bytes = runInChild(what, limits, [&]() -> Result<std::string> {
    auto loaded = loadCadFile(path, *file);
    if (!loaded) return unreadable(path, loaded.error().message);
    const auto model = makeBodies(std::move(*loaded), options);
    if (!model) return unreadable(path, model.error().message);
    return bytesOfModel(*model);
  });
  if (!bytes) return tl::unexpected<Error>(explain(bytes.error(), path, *file));
  auto model = modelOfBytes(*bytes);
  if (!model) return model;
  std::vector<std::string> warnings = file->text.warnings;
  warnings.insert(warnings.end(), file->scan.warnings.begin(), file->scan.warnings.end());
  warnings.insert(warnings.end(), model->warnings.begin(), model->warnings.end());
  model->warnings = std::move(warnings);
  return model;
}

}  // namespace phront::cad
