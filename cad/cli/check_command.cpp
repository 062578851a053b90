// phront check OUT --against IN -d D
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "cli.h"
#include "phront/cad/check.h"
#include "phront/cad/exchange.h"

namespace phront::cli {
namespace {

struct CheckArguments {
  std::filesystem::path out;
  std::filesystem::path in;
  std::string distance;
  CommonOptions common;
};

void print(const cad::CheckResult& check, double distance) {
  const double d = std::abs(distance);
  const auto line = [&](const char* name, double p99, double largest) {
    fmt::print("{:<10} 99 % within {:.4g} mm ({:.3g} % of d), largest {:.4g} mm ({:.3g} % of d)\n",
               name, p99, 100 * p99 / d, largest, 100 * largest / d);
  };
  fmt::print("{} solid(s), {} shell(s), {} face(s), volume {:.8g} mm3, {}, {}\n", check.solids,
             check.shells, check.faces, check.volume, check.valid ? "valid" : "NOT valid",
             check.closed ? "closed" : "NOT closed");
  line("deviation", check.accuracyP99, check.accuracyMax);
  line("coverage", check.coverageP99, check.coverageMax);
  fmt::print("{:.4g} % of the area on the right side, {:.4g} % where the result overlaps itself\n",
             100 * check.rightSide, 100 * check.buried);
  if (check.pass()) {
    fmt::print("PASS: OUT is the offset of IN by {:g} mm\n", distance);
    return;
  }
  for (const std::string& reason : check.reasons) fmt::print("FAIL: {}\n", reason);
}

int runCheck(const CheckArguments& arguments) {
  const CommonOptions& common = arguments.common;
  const Result<double> distance = parseLength(arguments.distance, common.unit);
  if (!distance) return reportError(distance.error());
  cad::CheckOptions options;
  options.distance = *distance;
  if (!common.tolerance.empty()) {
    const Result<double> tolerance = parseLength(common.tolerance, common.unit);
    if (!tolerance) return reportError(tolerance.error());
    if (!(*tolerance > 0)) return reportUsage("the tolerance must be positive");
    options.tolerance = *tolerance;
  }
  const Result<cad::Model> in = cad::readModel(arguments.in);
  if (!in) return reportError(in.error());
  cad::ReadOptions asWritten;
  asWritten.repair = false;  // the judged file is taken as it is
  const Result<cad::Model> out = cad::readModel(arguments.out, asWritten);
  if (!out) return reportError(out.error());
  const Result<cad::CheckResult> check = cad::checkOffset(*in, *out, options, makeProgress(common));
  endProgress(common);
  if (!check) return reportError(check.error());
  if (common.report != "-" && !common.quiet) print(*check, *distance);
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
      "check", "Measure whether OUT is the offset of IN: validity, deviation, coverage");
  auto arguments = std::make_shared<CheckArguments>();
  command->add_option("OUT", arguments->out, "The offset to judge")->required();
  command->add_option("--against", arguments->in, "The part it was made from")->required();
  command->add_option("-d,--distance", arguments->distance, "Signed distance")->required();
  addCommonOptions(*command, arguments->common);
  command->callback([arguments, &exitCode] { exitCode = runCheck(*arguments); });
}

}  // namespace phront::cli
