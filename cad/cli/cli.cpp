#include "cli.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <map>
#include <system_error>

#include "phront/mesh_io.h"

namespace phront::cli {
namespace {

constexpr int kBarWidth = 30;

std::atomic<int> interruptCount{0};

// Seconds that the work has to notice that it shall stop; files are written aside, so nothing half
// done is left when it does not.
constexpr unsigned kGraceSeconds = 3;

void onInterrupt(int signal) {
  // A second Ctrl-C does not wait for the work to notice.
  if (signal == SIGALRM || interruptCount.fetch_add(1) > 0) _exit(kInterrupted);
  alarm(kGraceSeconds);
}

bool showsBar(const CommonOptions& options) { return !options.quiet && isatty(STDERR_FILENO) != 0; }

}  // namespace

void addCommonOptions(CLI::App& command, CommonOptions& options) {
  command.add_option("--tol", options.tolerance,
                     "Largest deviation accepted (99th percentile); default 1 % of |d|");
  command.add_option("--threads", options.threads, "Threads; 0 is all cores")
      ->check(CLI::Range(0, 1024));
  command.add_option("--unit", options.unit,
                     "Unit of lengths given without one (mm cm m in ft um)");
  command.add_option("--report", options.report, "Write a JSON report; - is standard output");
  command.add_option("--picture", options.picture, "Write a PNG of input and result");
  command.add_flag("--keep", options.keep, "Write the result even where it misses its tolerance");
  command.add_flag("-q,--quiet", options.quiet, "Say nothing but errors");
  command.add_flag("-v,--verbose", options.verbose, "Say more: attempts and time of each stage");
}

Result<double> parseLength(const std::string& text, const std::string& defaultUnit) {
  static const std::map<std::string, double> kMillimetres = {
      {"mm", 1}, {"cm", 10}, {"m", 1000}, {"um", 1e-3}, {"in", 25.4}, {"ft", 304.8}};
  std::size_t used = 0;
  double value = 0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    return fail(
        ErrorCode::InvalidArgument,
        fmt::format("'{}' is not a length; write a number and a unit, such as 2mm or 0.1in", text));
  }
  std::string unit = text.substr(used);
  while (!unit.empty() && unit.front() == ' ') unit.erase(0, 1);
  if (unit.empty()) unit = defaultUnit;
  const auto known = kMillimetres.find(unit);
  if (known == kMillimetres.end())
    return fail(ErrorCode::InvalidArgument,
                fmt::format("'{}' is not a known unit; use mm, cm, m, um, in or ft", unit));
  if (!std::isfinite(value))
    return fail(ErrorCode::InvalidArgument, fmt::format("'{}' is not a finite length", text));
  return value * known->second;
}

int reportError(const Error& error) {
  fmt::print(stderr, "phront: {}{}\n", error.message,
             error.where.empty() ? "" : " (" + error.where + ")");
  switch (error.code) {
    case ErrorCode::InvalidArgument:
      return kUsage;
    case ErrorCode::UnreadableInput:
      return kUnreadable;
    case ErrorCode::OutOfTolerance:
      return kOutOfTolerance;
    case ErrorCode::Cancelled:
      return kInterrupted;
    default:
      return kFailed;
  }
}

int reportUsage(const std::string& sentence) {
  return reportError({ErrorCode::InvalidArgument, sentence, {}});
}

Progress makeProgress(const CommonOptions& options) {
  const bool bar = showsBar(options);
  return Progress([bar](double fraction, std::string_view stage) {
    if (bar) {
      const int filled = static_cast<int>(fraction * kBarWidth);
      fmt::print(stderr, "\r[{:#<{}}{:.<{}}] {:3.0f} % {:<20}", "", filled, "", kBarWidth - filled,
                 100 * fraction, stage);
      std::fflush(stderr);
    }
    return interruptCount.load() == 0;
  });
}

void endProgress(const CommonOptions& options) {
  if (showsBar(options)) fmt::print(stderr, "\r{:<{}}\r", "", kBarWidth + 40);
}

void installInterruptHandler() {
  struct sigaction action = {};
  action.sa_handler = onInterrupt;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGALRM, &action, nullptr);
  signal(SIGPIPE, SIG_IGN);  // a closed pipe is an error to report, not a death
}

bool interrupted() { return interruptCount.load() > 0; }

Result<void> checkOutputPath(const std::filesystem::path& out, const std::filesystem::path& in) {
  std::error_code error;
  if (std::filesystem::is_directory(out, error))
    return fail(ErrorCode::InvalidArgument,
                fmt::format("the output {} is a folder; give a file name", out.string()));
  if (std::filesystem::exists(out, error) && std::filesystem::equivalent(in, out, error))
    return fail(ErrorCode::InvalidArgument,
                "the output is the input file; the input is never overwritten, give another name");
  std::filesystem::path folder = out.parent_path();
  if (folder.empty()) folder = ".";
  if (!std::filesystem::is_directory(folder, error))
    return fail(ErrorCode::CannotWrite,
                fmt::format("the output folder {} does not exist; make it first", folder.string()));
  if (access(folder.c_str(), W_OK) != 0)
    return fail(ErrorCode::CannotWrite,
                fmt::format("no permission to write into {}", folder.string()));
  return {};
}

bool isMeshPath(const std::filesystem::path& path) { return meshFormatOf(path).has_value(); }

Result<void> writeReport(const nlohmann::json& report, const CommonOptions& options) {
  if (options.report.empty()) return {};
  const std::string text = report.dump(2) + "\n";
  if (options.report == "-") {
    fmt::print("{}", text);
    return {};
  }
  return writeFileAtomically(options.report, text);
}

const char* wordFor(cad::SurfaceType type) {
  static constexpr const char* kWords[] = {"plane",      "cylinder",  "cone",    "sphere", "torus",
                                           "revolution", "extrusion", "bspline", "other"};
  return kWords[static_cast<int>(type)];
}

nlohmann::json jsonOf(const cad::CheckResult& check) {
  return {{"pass", check.pass()},
          {"reasons", check.reasons},
          {"solids", check.solids},
          {"shells", check.shells},
          {"faces", check.faces},
          {"valid", check.valid},
          {"closed", check.closed},
          {"volume_mm3", check.volume},
          {"accuracy_p99_mm", check.accuracyP99},
          {"accuracy_max_mm", check.accuracyMax},
          {"coverage_p99_mm", check.coverageP99},
          {"coverage_max_mm", check.coverageMax},
          {"right_side", check.rightSide},
          {"overlapping", check.buried},
          {"true_offset_empty", check.trueOffsetEmpty},
          {"worst_point", {check.worstPoint.x(), check.worstPoint.y(), check.worstPoint.z()}}};
}

}  // namespace phront::cli
