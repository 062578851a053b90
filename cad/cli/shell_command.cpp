// phront shell IN -o OUT -t T --open FACE,...
#include <fmt/format.h>

#include <memory>

#include "body_reports.h"
#include "cli.h"
#include "phront/cad/exchange.h"
#include "phront/cad/shell_shape.h"
#include "shell_wish.h"

namespace phront::cli {
namespace {

struct ShellArguments {
  std::filesystem::path in;
  std::filesystem::path out;
  ShellWish wish;
  FaceWish faces;
  double timeLimit = cad::ShellOptions().timeLimit;
  CommonOptions common;
};

nlohmann::json jsonOf(const cad::ShellReport& report, const ShellArguments& arguments) {
  return {{"thickness_mm", report.options.thickness},
          {"thickness_of", arguments.faces.terms},
          {"side", arguments.wish.side},
          {"open_faces", report.options.open.size()},
          {"tolerance_mm", report.options.tolerance.value_or(0)},
          {"bodies", cli::jsonOf(report.bodies)},
          {"check", cli::jsonOf(report.check)},
          {"warnings", report.warnings},
          {"seconds", cli::jsonOf(report.times)}};
}

std::string summaryOf(const cad::ShellReport& report) {
  const cad::CheckResult& check = report.check;
  return fmt::format(
      "{} solid(s), {}, volume {:.6g} mm3; measured thickness {:g} mm +- {:.3g} mm (99 % of the "
      "walls), largest deviation {:.3g} mm",
      check.solids, facesOf(report.bodies, true), check.volume, report.options.thickness,
      check.accuracyP99, check.accuracyMax);
}

int finish(const ShellArguments& arguments, const cad::Model& in, cad::ShellResult& result) {
  const CommonOptions& common = arguments.common;
  cad::ShellReport& report = result.report;
  for (std::size_t i = in.warnings.size(); i < report.warnings.size(); ++i)
    say(common, "warning: " + report.warnings[i]);
  if (result.model.bodies.empty()) {
    sayDetails(common, report.bodies, report.times);
    (void)writeReport(jsonOf(report, arguments), common);
    return reportError(
        {ErrorCode::Failed, "no shell could be made: " + report.check.reasons.front(), {}});
  }
  const Result<std::filesystem::path> written =
      cad::writeShell(in, result, arguments.out, common.keep);
  if (!written) return reportError(written.error());
  sayDetails(common, report.bodies, report.times);
  for (const auto& step :
       {writeReport(jsonOf(report, arguments), common),
        drawModels(in, arguments.in.filename().string(), result.model,
                   fmt::format("shell of {:g} mm", report.options.thickness), common)}) {
    if (!step) return reportError(step.error());
  }
  if (result.accepted()) {
    say(common, fmt::format("{}: {}", written->string(), summaryOf(report)));
    return kDone;
  }
  return reportError({ErrorCode::OutOfTolerance,
                      fmt::format("the result does not pass its check and was written to {}: {}",
                                  written->string(), report.check.reasons.front()),
                      {}});
}

int runShell(const ShellArguments& arguments) {
  const CommonOptions& common = arguments.common;
  if (const Result<void> ok = checkOutputPath(arguments.out, arguments.in); !ok)
    return reportError(ok.error());
  if (isMeshPath(arguments.in) || isMeshPath(arguments.out))
    return reportUsage(
        "shells are made of CAD solids and sheets: name a STEP, IGES or BREP file in and out");
  if (const Result<cad::ShapeFormat> format = cad::shapeFormatOf(arguments.out); !format)
    return reportError(format.error());
  const Result<cad::Model> model = cad::readModel(arguments.in);
  if (!model) return reportError(model.error());
  for (const std::string& warning : model->warnings) say(common, "warning: " + warning);
  Result<cad::ShellOptions> options = resolve(arguments.wish, arguments.faces, *model, common);
  if (!options) return reportError(options.error());
  options->timeLimit = arguments.timeLimit;
  Result<cad::ShellResult> result = cad::shellModel(*model, *options, makeProgress(common));
  endProgress(common);
  if (!result) return reportError(result.error());
  if (interrupted()) return kInterrupted;
  return finish(arguments, *model, *result);
}

}  // namespace

void addShellCommand(CLI::App& app, int& exitCode) {
  CLI::App* command = app.add_subcommand("shell",
                                         "Hollow a solid (STEP IGES BREP) to a wall of one "
                                         "thickness, with open faces; thicken a sheet");
  auto arguments = std::make_shared<ShellArguments>();
  command->add_option("IN", arguments->in, "Input file")->required();
  command->add_option("-o,--output", arguments->out, "Output file; its extension names the format")
      ->required();
  addShellWish(*command, arguments->wish)->required();
  addFaceWish(*command, arguments->faces);
  command
      ->add_option("--time-limit", arguments->timeLimit,
                   "Seconds for all attempts and their checks; writing comes on top")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  addCommonOptions(*command, arguments->common);
  command->callback([arguments, &exitCode] { exitCode = runShell(*arguments); });
}

}  // namespace phront::cli
