// phront offset IN -o OUT -d D
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <memory>

#include "body_reports.h"
#include "cli.h"
#include "face_wish.h"
#include "join_wish.h"
#include "offset_drawing.h"
#include "offset_mesh.h"
#include "offset_surfaces.h"
#include "phront/cad/exchange.h"
#include "phront/cad/offset_shape.h"

namespace phront::cli {
namespace {

struct OffsetArguments {
  std::filesystem::path in;
  std::filesystem::path out;
  std::string distance;
  JoinWish join;
  FaceWish faces;
  bool parametric = false;
  bool surfaces = false;
  double timeLimit = cad::OffsetOptions().timeLimit;
  CommonOptions common;
};

nlohmann::json jsonOf(const cad::OffsetReport& report, const FaceWish& faces) {
  return {{"distance_mm", report.options.distance},
          {"distance_of", faces.terms},
          {"join", report.options.join == cad::Join::Mitre ? "mitre" : "arc"},
          {"tolerance_mm", report.options.tolerance.value_or(0)},
          {"bodies", cli::jsonOf(report.bodies)},
          {"check", cli::jsonOf(report.check)},
          {"warnings", report.warnings},
          {"seconds", cli::jsonOf(report.times)}};
}

std::string summaryOf(const cad::OffsetReport& report) {
  const cad::CheckResult& check = report.check;
  const bool solid = check.solids > 0;
  std::string text = solid ? fmt::format("{} solid(s), ", check.solids) : "a sheet of ";
  text += facesOf(report.bodies, solid);
  if (solid) text += fmt::format(", volume {:.6g} mm3", check.volume);
  const double d = std::abs(report.options.distance);
  text += fmt::format(
      "; measured deviation {:.3g} mm (99 % of the area, {:.2g} % of d), "
      "largest "
      "{:.3g} mm",
      check.accuracyP99, 100 * check.accuracyP99 / d, check.accuracyMax);
  return text;
}

/// `moved`: `in`, with the faces moved that have a distance of their own.
int finish(const OffsetArguments& arguments, const cad::Model& in, const cad::Model& moved,
           cad::OffsetResult& result) {
  const cad::OffsetReport& report = result.report;
  for (std::size_t i = in.warnings.size(); i < report.warnings.size(); ++i)
    say(arguments.common, "warning: " + report.warnings[i]);
  if (result.model.bodies.empty() && result.accepted()) {
    say(arguments.common, "the part is thinner than 2|d| everywhere: its offset is empty");
    sayDetails(arguments.common, report.bodies, report.times);
    const Result<void> written = writeReport(jsonOf(report, arguments.faces), arguments.common);
    return written ? kDone : reportError(written.error());
  }
  if (result.model.bodies.empty()) {
    sayDetails(arguments.common, report.bodies, report.times);
    (void)writeReport(jsonOf(report, arguments.faces), arguments.common);
    return reportError(
        {ErrorCode::Failed, "no offset could be made: " + report.check.reasons.front(), {}});
  }
  const Result<std::filesystem::path> written =
      cad::writeOffset(moved, result, arguments.out, arguments.common.keep);
  if (!written) return reportError(written.error());
  sayDetails(arguments.common, report.bodies, report.times);
  for (const auto& step :
       {writeReport(jsonOf(report, arguments.faces), arguments.common),
        drawModels(in, arguments.in.filename().string(), result.model,
                   fmt::format("offset {:+g} mm", report.options.distance), arguments.common)}) {
    if (!step) return reportError(step.error());
  }
  if (result.accepted()) {
    say(arguments.common, fmt::format("{}: {}", written->string(), summaryOf(report)));
    return kDone;
  }
  return reportError({ErrorCode::OutOfTolerance,
                      fmt::format("the result does not pass its check and was written to {}: {}",
                                  written->string(), report.check.reasons.front()),
                      {}});
}

int runOffset(const OffsetArguments& arguments) {
  const Result<double> distance = parseLength(arguments.distance, arguments.common.unit);
  if (!distance) return reportError(distance.error());
  if (*distance == 0) return reportUsage("the offset distance is 0: there is nothing to do");
  cad::OffsetOptions options;
  options.distance = *distance;
  options.threads = arguments.common.threads;
  options.timeLimit = arguments.timeLimit;
  options.join = arguments.join.join;
  options.mitreLimit = arguments.join.mitreLimit;
  const Result<std::optional<double>> tolerance = toleranceOf(arguments.common);
  if (!tolerance) return reportError(tolerance.error());
  options.tolerance = *tolerance;
  if (const Result<void> ok = checkOutputPath(arguments.out, arguments.in); !ok)
    return reportError(ok.error());
  const auto isSolidPath = [](const std::filesystem::path& path) {
    return !isMeshPath(path) && !isDrawingPath(path);
  };
  if (options.join == cad::Join::Mitre &&
      (arguments.surfaces || !isSolidPath(arguments.in) || !isSolidPath(arguments.out)))
    return reportUsage("--join mitre makes CAD solids: name a STEP, IGES or BREP file in and out");
  if (!arguments.faces.terms.empty() &&
      (arguments.surfaces || !isSolidPath(arguments.in) || !isSolidPath(arguments.out)))
    return reportUsage(
        "--distance-of is for faces of CAD solids: name a STEP, IGES or BREP file in and out");
  if (isDrawingPath(arguments.in) || isDrawingPath(arguments.out)) {
    const bool fromCurves = isDrawingPath(arguments.in) || cad::shapeFormatOf(arguments.in);
    if (!fromCurves || !isDrawingPath(arguments.out))
      return reportUsage(
          "curves give a drawing: name the output .svg or .dxf, the input so too, or a CAD file of "
          "planar wires");
    if (arguments.parametric) return reportUsage("--parametric moves mesh nodes, not drawings");
    if (arguments.surfaces) return reportUsage("--surfaces offsets CAD faces, not drawings");
    return offsetDrawingFile(arguments.in, arguments.out, *distance, options.tolerance,
                             arguments.common);
  }
  const bool meshOut = isMeshPath(arguments.out);
  if (!meshOut) {
    const Result<cad::ShapeFormat> format = cad::shapeFormatOf(arguments.out);
    if (!format) return reportError(format.error());
  }
  if (arguments.surfaces && (meshOut || isMeshPath(arguments.in)))
    return reportUsage("--surfaces offsets CAD faces: name a STEP, IGES or BREP file in and out");
  if (isMeshPath(arguments.in)) {
    if (!meshOut)
      return reportUsage("a mesh gives a mesh: name the output .stl, .obj, .ply or .vtu");
    return offsetMeshFile(arguments.in, arguments.out, *distance, arguments.parametric,
                          options.tolerance, arguments.common);
  }
  const Result<cad::Model> model = cad::readModel(arguments.in);
  if (!model) return reportError(model.error());
  for (const std::string& warning : model->warnings) say(arguments.common, "warning: " + warning);
  if (meshOut)
    return offsetModelToMesh(*model, arguments.in, arguments.out, *distance, arguments.parametric,
                             options.tolerance, arguments.common);
  if (arguments.parametric)
    return reportUsage("--parametric moves mesh nodes: name a mesh output (.stl .obj .ply .vtu)");
  if (arguments.surfaces) {
    cad::SurfacesOptions forSurfaces;
    forSurfaces.distance = options.distance;
    forSurfaces.tolerance = options.tolerance;
    forSurfaces.threads = options.threads;
    forSurfaces.timeLimit = options.timeLimit;
    return offsetSurfacesFile(*model, arguments.in, arguments.out, forSurfaces, arguments.common);
  }
  const Result<cad::Model> moved =
      withFacesMoved(arguments.faces, *model, *distance, arguments.common);
  if (!moved) return reportError(moved.error());
  Result<cad::OffsetResult> result =
      cad::offsetModel(*moved, options, makeProgress(arguments.common));
  endProgress(arguments.common);
  if (!result) return reportError(result.error());
  if (interrupted()) return kInterrupted;
  return finish(arguments, *model, *moved, *result);
}

}  // namespace

void addOffsetCommand(CLI::App& app, int& exitCode) {
  CLI::App* command = app.add_subcommand(
      "offset",
      "Offset a part (STEP IGES BREP), a mesh (STL OBJ PLY) or a drawing (SVG DXF) by a signed "
      "distance");
  auto arguments = std::make_shared<OffsetArguments>();
  command->add_option("IN", arguments->in, "Input file")->required();
  command->add_option("-o,--output", arguments->out, "Output file; its extension names the format")
      ->required();
  command
      ->add_option("-d,--distance", arguments->distance,
                   "Distance: positive grows the solid, negative shrinks it")
      ->required();
  addJoinWish(*command, arguments->join);
  addFaceWish(*command, arguments->faces);
  command->add_flag("--parametric", arguments->parametric,
                    "Mesh output: move the input's own nodes, keep connectivity and order");
  command->add_flag("--surfaces", arguments->surfaces,
                    "CAD output: the trimmed offset surface of every face, not sewn to a solid");
  command
      ->add_option("--time-limit", arguments->timeLimit,
                   "Seconds for all attempts and their checks; writing comes on top")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  addCommonOptions(*command, arguments->common);
  command->callback([arguments, &exitCode] { exitCode = runOffset(*arguments); });
}

}  // namespace phront::cli
