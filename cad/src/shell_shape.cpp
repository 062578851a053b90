#include "phront/cad/shell_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "add_times.h"
#include "carry_marks.h"
#include "deadline.h"
#include "judge/check_body.h"
#include "judge/check_shell.h"
#include "judge/check_thick.h"
#include "shell/shell_body.h"
#include "shell/thicken_body.h"
#include "shell/wall_bases.h"
#include "write_checked.h"

namespace phront::cad {
namespace {

constexpr double kToleranceOfThickness = 0.01;

std::string nameOf(const Model& model, std::size_t body) {
  const std::string& name = model.bodies[body].name;
  return name.empty() ? fmt::format("body {}", body + 1) : fmt::format("body '{}'", name);
}

Result<void> checkRequest(const Model& model, const ShellOptions& options) {
  if (!(options.thickness > 0) || !std::isfinite(options.thickness))
    return fail(
        ErrorCode::InvalidArgument,
        "the thickness must be a positive length; give -t in mm or with a unit, for example "
        "-t 2 or -t 0.1in");
  if (options.tolerance && !(*options.tolerance > 0 && std::isfinite(*options.tolerance)))
    return fail(ErrorCode::InvalidArgument, "the tolerance must be a positive length");
  if (!(options.timeLimit > 0))
    return fail(ErrorCode::InvalidArgument, "the time limit must be a positive number of seconds");
  if (model.bodies.empty())
    return fail(ErrorCode::InvalidArgument, "the model holds no body to give a wall");
  for (const FaceId& id : options.open) {
    if (id.body >= model.bodies.size() || id.face < 0 ||
        id.face >= faceCount(model.bodies[id.body].shape))
      return fail(ErrorCode::InvalidArgument, "a face to be left open is not in the model");
    if (model.bodies[id.body].kind == BodyKind::Sheet)
      return fail(ErrorCode::InvalidArgument,
                  nameOf(model, id.body) +
                      " is a sheet, which becomes a solid of the given thickness: it has no face "
                      "to leave open; only faces of solids can be");
  }
  for (const FaceThickness& own : options.thicknessOf) {
    if (!(own.thickness > 0) || !std::isfinite(own.thickness))
      return fail(ErrorCode::InvalidArgument, "the thickness of a face must be a positive length");
    if (std::find(options.open.begin(), options.open.end(), own.face) != options.open.end())
      return fail(ErrorCode::InvalidArgument,
                  "a face is left open and given a thickness: one of both");
  }
  return {};
}

/// All bodies' checks as one: sums, worst figures, all reasons.
void addCheck(CheckResult& whole, const CheckResult& part, const std::string& who) {
  whole.solids += part.solids;
  whole.shells += part.shells;
  whole.faces += part.faces;
  whole.volume += part.volume;
  whole.valid = whole.valid && part.valid;
  whole.closed = whole.closed && part.closed;
  whole.accuracyP99 = std::max(whole.accuracyP99, part.accuracyP99);
  whole.accuracyMax = std::max(whole.accuracyMax, part.accuracyMax);
  whole.coverageP99 = std::max(whole.coverageP99, part.coverageP99);
  whole.coverageMax = std::max(whole.coverageMax, part.coverageMax);
  whole.buried = std::max(whole.buried, part.buried);
  whole.untessellatedFaces += part.untessellatedFaces;
  for (const std::string& reason : part.reasons)
    whole.reasons.push_back(who.empty() ? reason : who + ": " + reason);
}

CheckResult emptyCheck() {
  CheckResult check;
  check.valid = true;
  check.closed = true;
  return check;
}

/// The body whose box differs least.
std::size_t mostAlike(const Model& in, const Body& shell) {
  const Box3 box = boundingBox(shell.shape);
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < in.bodies.size(); ++b) {
    const Box3 other = boundingBox(in.bodies[b].shape);
    const double difference = (box.min() - other.min()).norm() + (box.max() - other.max()).norm();
    if (difference >= least) continue;
    least = difference;
    best = b;
  }
  return best;
}

}  // namespace

Result<ShellResult> shellModel(const Model& model, const ShellOptions& requested,
                               const Progress& progress) {
  if (const Result<void> ok = checkRequest(model, requested); !ok)
    return tl::unexpected(ok.error());
  ShellResult result;
  ShellReport& report = result.report;
  report.options = requested;
  report.options.tolerance =
      requested.tolerance.value_or(kToleranceOfThickness * requested.thickness);
  report.warnings = model.warnings;
  result.model.assemblies = model.assemblies;
  report.check = emptyCheck();
  const Deadline deadline(requested.timeLimit);
  const Result<std::vector<WallBases>> bases = wallBasesOf(model, requested);
  if (!bases) return tl::unexpected(bases.error());
  const std::size_t count = model.bodies.size();
  int firstNumber = 1;
  for (std::size_t b = 0; b < count; ++b) {
    ShellBodyRequest request;
    request.open = openFacesOf(requested, b);
    request.firstNumber = firstNumber;
    firstNumber += faceCount(model.bodies[b].shape);
    request.walls = wallsOf(requested);
    request.bases = (*bases)[b];
    request.tolerance = *report.options.tolerance;
    request.threads = requested.threads;
    request.timeLimit = deadline.left() / static_cast<double>(count - b);
    const auto share = [&](std::size_t k) {
      return static_cast<double>(k) / static_cast<double>(count);
    };
    const auto make = model.bodies[b].kind == BodyKind::Sheet ? thickenBody : shellBody;
    Result<BodyShell> shell = make(model.bodies[b], request, progress.part(share(b), share(b + 1)));
    if (!shell) return tl::unexpected(shell.error());
    if (shell->full)
      report.warnings.push_back(nameOf(model, b) +
                                " is too thin to be hollow: the wall fills it, it stays as it is");
    addCheck(report.check, shell->report.check, count > 1 ? nameOf(model, b) : std::string());
    addTimes(report.times, shell->times);
    carryMarks(model.bodies[b], requested.thickness, shell->bodies);
    for (Body& body : shell->bodies) result.model.bodies.push_back(std::move(body));
    report.bodies.push_back(std::move(shell->report));
  }
  return result;
}

Result<CheckResult> checkShell(const Model& in, const Model& out, const ShellOptions& options,
                               int samples) {
  if (const Result<void> ok = checkRequest(in, options); !ok) return tl::unexpected(ok.error());
  std::vector<std::vector<Body>> shells(in.bodies.size());
  for (const Body& body : out.bodies) shells[mostAlike(in, body)].push_back(body);
  const Deadline deadline(options.timeLimit);
  const Result<std::vector<WallBases>> bases = wallBasesOf(in, options);
  if (!bases) return tl::unexpected(bases.error());
  CheckResult whole = emptyCheck();
  for (std::size_t b = 0; b < in.bodies.size(); ++b) {
    ShellCheckOptions check;
    check.walls = wallsOf(options);
    check.bases = (*bases)[b];
    check.tolerance = options.tolerance.value_or(kToleranceOfThickness * options.thickness);
    check.samples = samples;
    check.timeLimit = std::max(1.0, deadline.left() / static_cast<double>(in.bodies.size() - b));
    const Result<CheckResult> part =
        in.bodies[b].kind == BodyKind::Sheet
            ? checkThickSheet(in.bodies[b], shells[b], check)
            : checkBodyShell(in.bodies[b], openFacesOf(options, b), shells[b], check);
    if (!part) return tl::unexpected(part.error());
    addCheck(whole, *part, in.bodies.size() > 1 ? nameOf(in, b) : std::string());
  }
  return whole;
}

Result<std::filesystem::path> writeShell(const Model& in, ShellResult& result,
                                         const std::filesystem::path& path, bool keep) {
  const ShellOptions& made = result.report.options;
  const Recheck recheck = [&](const Model& back, double seconds) {
    ShellOptions options = made;
    options.timeLimit = seconds;
    return checkShell(in, back, options, kOfferedSamples);
  };
  return writeChecked(result.model, {path, keep, made.timeLimit, result.report.times, 0}, recheck,
                      result.report.check);
}

}  // namespace phront::cad
