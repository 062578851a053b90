#include "offset_drawing.h"

#include <fmt/format.h>

#include <cmath>

#include "phront/cad/drawing.h"
#include "phront/cad/offset_shape.h"
#include "phront/curve_distance.h"
#include "phront/offset_curve.h"

namespace phront::cli {
namespace {

constexpr double kToleranceOfDistance = 1e-3;
// Of the tolerance: for chords of the drawing's curves; for the front.
constexpr double kReadShare = 0.2;
constexpr double kFrontShare = 0.8;

void say(const CommonOptions& options, const std::string& sentence) {
  if (!options.quiet) fmt::print(stderr, "{}\n", sentence);
}

}  // namespace

bool isDrawingPath(const std::filesystem::path& path) {
  return cad::drawingFormatOf(path).has_value();
}

int offsetDrawingFile(const std::filesystem::path& in, const std::filesystem::path& out,
                      double distance, std::optional<double> tolerance,
                      const CommonOptions& options) {
  if (!options.picture.empty())
    return reportUsage("--picture shows solids and meshes: a drawing is a picture itself");
  const double allowed = tolerance.value_or(kToleranceOfDistance * std::abs(distance));
  const auto drawing = cad::readDrawing(in, {.tolerance = kReadShare * allowed});
  if (!drawing) return reportError(drawing.error());
  for (const std::string& warning : drawing->warnings) say(options, "warning: " + warning);
  const auto curves = CurveDistance::build(drawing->curves);
  if (!curves) return reportError(curves.error());
  const auto offset = offsetCurve(
      *curves,
      {.distance = distance, .tolerance = kFrontShare * allowed, .threads = options.threads},
      makeProgress(options));
  endProgress(options);
  if (!offset) return reportError(offset.error());
  if (interrupted()) return kInterrupted;
  const double deviation = offset->deviation + kReadShare * allowed;
  const nlohmann::json report = {{"distance_mm", distance},
                                 {"tolerance_mm", allowed},
                                 {"loops_in", drawing->loops},
                                 {"open_in", drawing->open},
                                 {"curves_out", curveCount(offset->curves)},
                                 {"points_out", offset->curves.points.size()},
                                 {"deviation_mm", deviation}};
  if (const Result<void> ok = writeReport(report, options); !ok) return reportError(ok.error());
  if (offset->curves.segments.empty()) {
    say(options, "the drawing is thinner than 2|d| everywhere: its offset is empty");
    return kDone;
  }
  const bool pass = deviation <= allowed;
  const std::filesystem::path target = pass || options.keep ? out : cad::rejectedPath(out);
  if (const Result<void> ok = cad::writeDrawing(offset->curves, target); !ok)
    return reportError(ok.error());
  const std::string figures = fmt::format(
      "{} closed and {} open curves in, {} out, {} points; measured deviation at most {:.3g} mm, "
      "chords of the drawing included",
      drawing->loops, drawing->open, curveCount(offset->curves), offset->curves.points.size(),
      deviation);
  if (pass) {
    say(options, target.string() + ": " + figures);
    return kDone;
  }
  return reportError({ErrorCode::OutOfTolerance,
                      fmt::format("the deviation is above the tolerance of {:.3g} mm; written to "
                                  "{}: {}",
                                  allowed, target.string(), figures),
                      {}});
}

}  // namespace phront::cli
