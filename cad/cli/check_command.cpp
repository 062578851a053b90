// phront check OUT --against IN -d D, or -t T --open FACE,...
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "body_reports.h"
#include "cli.h"
#include "face_wish.h"
#include "join_wish.h"
#include "phront/cad/check.h"
#include "phront/cad/exchange.h"
#include "shell_wish.h"

namespace phront::cli {
namespace {

struct CheckArguments {
  std::filesystem::path out;
  std::filesystem::path in;
  std::string distance;
  JoinWish join;
  FaceWish faces;
  ShellWish shell;  ///< of a shell: no distance then
  CommonOptions common;
};

/// `wanted`: what OUT should be; `d`: the length that deviations are percentages of.
void print(const cad::CheckResult& check, double d, bool shell, const std::string& wanted) {
  const char* of = shell ? "t" : "d";
  const auto line = [&](const char* name, double p99, double largest) {
    fmt::print(
        "{:<10} 99 % within {:.4g} mm ({:.3g} % of {}), largest {:.4g} mm ({:.3g} % of {})\n", name,
        p99, 100 * p99 / d, of, largest, 100 * largest / d, of);
  };
  fmt::print("{} solid(s), {} shell(s), {} face(s), volume {:.8g} mm3, {}, {}\n", check.solids,
             check.shells, check.faces, check.volume, check.valid ? "valid" : "NOT valid",
             check.closed ? "closed" : "NOT closed");
  line(shell ? "thickness" : "deviation", check.accuracyP99, check.accuracyMax);
  line("coverage", check.coverageP99, check.coverageMax);
  if (!shell) fmt::print("{:.4g} % of the area on the right side\n", 100 * check.rightSide);
  fmt::print("{:.4g} % of the area where the result overlaps itself\n", 100 * check.buried);
  if (check.pass()) {
    fmt::print("PASS: OUT is {}\n", wanted);
    return;
  }
  for (const std::string& reason : check.reasons) fmt::print("FAIL: {}\n", reason);
}

int runCheck(const CheckArguments& arguments) {
  const CommonOptions& common = arguments.common;
  const bool shell = !arguments.shell.thickness.empty();
  if (shell == !arguments.distance.empty())
    return reportUsage("say what OUT should be: an offset (-d) or a shell (-t)");
  if (!shell && !arguments.shell.open.empty())
    return reportUsage("--open belongs to shells: give their thickness (-t)");
  if (shell && arguments.join.join == cad::Join::Mitre)
    return reportUsage("--join mitre belongs to offsets: give their distance (-d)");
  const Result<double> length =
      parseLength(shell ? arguments.shell.thickness : arguments.distance, common.unit);
  if (!length) return reportError(length.error());
  const Result<std::optional<double>> tolerance = toleranceOf(common);
  if (!tolerance) return reportError(tolerance.error());
  const Result<cad::Model> in = cad::readModel(arguments.in);
  if (!in) return reportError(in.error());
  cad::ReadOptions asWritten;
  asWritten.repair = false;  // the judged file is taken as it is
  const Result<cad::Model> out = cad::readModel(arguments.out, asWritten);
  if (!out) return reportError(out.error());
  Result<cad::CheckResult> check;
  if (shell) {
    Result<cad::ShellOptions> options = resolve(arguments.shell, arguments.faces, *in, common);
    if (!options) return reportError(options.error());
    check = cad::checkShell(*in, *out, *options);
  } else {
    cad::CheckOptions options;
    options.distance = *length;
    options.tolerance = *tolerance;
    options.join = arguments.join.join;
    options.mitreLimit = arguments.join.mitreLimit;
    const Result<cad::Model> moved = withFacesMoved(arguments.faces, *in, *length, common);
    if (!moved) return reportError(moved.error());
    check = cad::checkOffset(*moved, *out, options, makeProgress(common));
    endProgress(common);
  }
  if (!check) return reportError(check.error());
  if (common.report != "-" && !common.quiet)
    print(*check, std::abs(*length), shell,
          shell ? fmt::format("the shell of IN, {:g} mm thick", *length)
                : fmt::format("the offset of IN by {:g} mm", *length));
  if (const Result<void> ok = writeReport(jsonOf(*check), common); !ok)
    return reportError(ok.error());
  if (const Result<void> ok = drawModels(*in, arguments.in.filename().string(), *out,
                                         arguments.out.filename().string(), common);
      !ok)
    return reportError(ok.error());
  return check->pass() ? kDone : kOutOfTolerance;
}

}  // namespace

void addCheckCommand(CLI::App& app, int& exitCode) {
  CLI::App* command = app.add_subcommand(
      "check", "Measure whether OUT is the offset (or shell) of IN: validity, deviation, coverage");
  auto arguments = std::make_shared<CheckArguments>();
  command->add_option("OUT", arguments->out, "The offset to judge")->required();
  command->add_option("--against", arguments->in, "The part it was made from")->required();
  command->add_option("-d,--distance", arguments->distance, "Signed distance of an offset");
  addJoinWish(*command, arguments->join);
  addFaceWish(*command, arguments->faces);
  addShellWish(*command, arguments->shell);
  addCommonOptions(*command, arguments->common);
  command->callback([arguments, &exitCode] { exitCode = runCheck(*arguments); });
}

}  // namespace phront::cli
