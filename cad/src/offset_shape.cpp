#include "phront/cad/offset_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <system_error>

#include <TopLoc_Location.hxx>
#include <TopoDS_Shape.hxx>

#include "deadline.h"
#include "judge/check_body.h"
#include "phront/cad/exchange.h"
#include "phront/cad/shape_occt.h"
#include "rebuild/body_offset.h"

namespace phront::cad {
namespace {

// Of the time left, for the bodies; the rest is for the check of the whole.
constexpr double kBodiesShare = 0.8;
constexpr double kLeastBodySeconds = 2;
// Bodies with faults: mostly in vain, so not for long.
constexpr double kInvalidBodySeconds = 20;
// Each, for reading the written file back and for checking what was read.
constexpr double kReadBackSeconds = 20;
constexpr double kLeastCheckSeconds = 10;

Result<OffsetOptions> resolve(const Model& model, OffsetOptions options) {
  if (!std::isfinite(options.distance) || options.distance == 0)
    return fail(ErrorCode::InvalidArgument,
                "the offset distance must be a finite number other than 0; give -d in mm or with a "
                "unit, for example -d 2 or -d -0.1in");
  if (options.tolerance && !(*options.tolerance > 0 && std::isfinite(*options.tolerance)))
    return fail(ErrorCode::InvalidArgument, "the tolerance must be a positive length");
  if (!(options.timeLimit > 0))
    return fail(ErrorCode::InvalidArgument, "the time limit must be a positive number of seconds");
  if (model.bodies.empty())
    return fail(ErrorCode::InvalidArgument, "the model holds no body to offset");
  if (!options.tolerance) options.tolerance = 0.01 * std::abs(options.distance);
  return options;
}

void addTimes(std::vector<StageTime>& sum, const std::vector<StageTime>& times) {
  for (const StageTime& time : times) {
    const auto same = std::find_if(sum.begin(), sum.end(),
                                   [&](const StageTime& s) { return s.stage == time.stage; });
    if (same == sum.end())
      sum.push_back(time);
    else
      same->seconds += time.seconds;
  }
}

// An instance of the same part as body i before it: assemblies place one shape many times.
std::optional<std::size_t> earlierTwin(const Model& model, std::size_t i) {
  const TopoDS_Shape& shape = occtShape(model.bodies[i].shape);
  for (std::size_t j = 0; j < i; ++j) {
    const TopoDS_Shape& other = occtShape(model.bodies[j].shape);
    if (model.bodies[j].kind == model.bodies[i].kind && !shape.IsNull() && !other.IsNull() &&
        shape.IsPartner(other) && shape.Orientation() == other.Orientation()) {
      return j;
    }
  }
  return std::nullopt;
}

TopLoc_Location moveBetween(const Body& from, const Body& to) {
  return occtShape(to.shape).Location() * occtShape(from.shape).Location().Inverted();
}

// Of the time left for bodies i and on, by the number of faces; twins take none.
double shareOfTime(const Model& model, std::size_t i) {
  constexpr double kOverhead = 5;  // faces' worth of what every body costs
  const auto weight = [&](std::size_t j) { return faceCount(model.bodies[j].shape) + kOverhead; };
  double all = weight(i);
  for (std::size_t j = i + 1; j < model.bodies.size(); ++j) {
    if (!earlierTwin(model, j)) all += weight(j);
  }
  return weight(i) / all;
}

// The check of the whole: of the only body, or of all together (bodies may come to overlap).
CheckResult checkWhole(const Model& in, const OffsetResult& result, const Deadline& deadline) {
  const OffsetReport& report = result.report;
  if (report.bodies.size() == 1) return report.bodies.front().check;
  for (std::size_t i = 0; i < report.bodies.size(); ++i) {
    if (report.bodies[i].kind != OffsetKind::Failed) continue;
    CheckResult failed = report.bodies[i].check;
    failed.reasons.insert(
        failed.reasons.begin(),
        fmt::format("body {} of {} has no offset that passes", i + 1, report.bodies.size()));
    return failed;
  }
  CheckOptions options;
  options.distance = report.options.distance;
  options.tolerance = report.options.tolerance;
  options.timeLimit = deadline.forStep(1, kLeastCheckSeconds, options.timeLimit);
  const Result<CheckResult> check = checkOffset(in, result.model, options);
  if (!check) {
    CheckResult failed;
    failed.reasons.push_back(check.error().message);
    return failed;
  }
  CheckResult whole = *check;
  if (!whole.pass())
    whole.reasons.insert(whole.reasons.begin(),
                         "each body's own offset is right, but together they are not the offset of "
                         "the whole: bodies touch or come nearer than the distance");
  return whole;
}

}  // namespace

Result<OffsetResult> offsetModel(const Model& model, const OffsetOptions& requested,
                                 const Progress& progress) {
  const Result<OffsetOptions> options = resolve(model, requested);
  if (!options) return tl::unexpected(options.error());
  OffsetResult result;
  OffsetReport& report = result.report;
  report.options = *options;
  report.warnings = model.warnings;
  const double count = static_cast<double>(model.bodies.size());
  const Deadline deadline(options->timeLimit);
  const double forBodies = model.bodies.size() > 1 ? kBodiesShare : 1;
  std::vector<std::size_t> firstResult(model.bodies.size() + 1, 0);  // in result.model, by body
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Progress part = progress.part(0.95 * static_cast<double>(i) / count,
                                        0.95 * static_cast<double>(i + 1) / count);
    firstResult[i] = result.model.bodies.size();
    if (const std::optional<std::size_t> twin = earlierTwin(model, i)) {
      const TopLoc_Location move = moveBetween(model.bodies[*twin], model.bodies[i]);
      for (std::size_t k = firstResult[*twin]; k < firstResult[*twin + 1]; ++k) {
        Body body = result.model.bodies[k];
        body.name = model.bodies[i].name;
        body.shape = makeShape(occtShape(body.shape).Moved(move));
        result.model.bodies.push_back(std::move(body));
      }
      firstResult[i + 1] = result.model.bodies.size();
      BodyReport same = report.bodies[*twin];
      same.name = model.bodies[i].name;
      same.attempts = {fmt::format("the same part as body {}, moved", *twin + 1)};
      report.bodies.push_back(std::move(same));
      continue;
    }
    OffsetOptions bodyOptions = *options;
    bodyOptions.timeLimit =
        deadline.forStep(forBodies * shareOfTime(model, i), kLeastBodySeconds, options->timeLimit);
    const Body& body = model.bodies[i];
    if (!body.valid) bodyOptions.timeLimit = std::min(bodyOptions.timeLimit, kInvalidBodySeconds);
    Result<BodyOffset> offset = offsetBody(body, bodyOptions, part);
    if (!offset) return tl::unexpected(offset.error());
    if (!body.valid && offset->report.kind == OffsetKind::Failed) {
      return fail(ErrorCode::UnreadableInput,
                  fmt::format("body {}{} is not valid (OpenCASCADE's check) and has no offset that "
                              "passes: repair it in the CAD system it comes from",
                              i + 1, body.name.empty() ? "" : " '" + body.name + "'"));
    }
    for (Body& body : offset->bodies) result.model.bodies.push_back(std::move(body));
    firstResult[i + 1] = result.model.bodies.size();
    addTimes(report.times, offset->times);
    report.bodies.push_back(std::move(offset->report));
  }
  if (!progress.part(0.95, 1, "check").report(0))
    return fail(ErrorCode::Cancelled, "the offset was cancelled");
  const auto start = std::chrono::steady_clock::now();
  report.check = checkWhole(model, result, deadline);
  addTimes(
      report.times,
      {{"check", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()}});
  return result;
}

std::filesystem::path rejectedPath(const std::filesystem::path& path) {
  std::filesystem::path rejected = path;
  rejected.replace_extension(".rejected" + path.extension().string());
  return rejected;
}

Result<std::filesystem::path> writeOffset(const Model& in, OffsetResult& result,
                                          const std::filesystem::path& path, bool keep) {
  if (result.model.bodies.empty()) return std::filesystem::path();
  std::filesystem::path aside = path;
  aside.replace_extension(".unchecked" + path.extension().string());
  if (Result<void> written = writeModel(result.model, aside); !written)
    return tl::unexpected(written.error());

  CheckResult& check = result.report.check;
  if (check.pass()) {
    ReadOptions asWritten;
    asWritten.repair = false;
    asWritten.timeLimit = kReadBackSeconds;
    const Result<Model> back = readModel(aside, asWritten);
    if (!back) {
      check.reasons.push_back("the written file cannot be read back: " + back.error().message);
    } else {
      CheckOptions options;
      options.distance = result.report.options.distance;
      options.tolerance = result.report.options.tolerance;
      options.samples = kOfferedSamples;
      options.timeLimit = kReadBackSeconds;
      const Result<CheckResult> again = checkOffset(in, *back, options);
      if (!again)
        check.reasons.push_back("the written file cannot be checked: " + again.error().message);
      else
        for (const std::string& reason : again->reasons)
          check.reasons.push_back("read back from the file: " + reason);
    }
  }
  const std::filesystem::path target = check.pass() || keep ? path : rejectedPath(path);
  std::error_code error;
  std::filesystem::rename(aside, target, error);
  if (error) {
    std::filesystem::remove(aside, error);
    return fail(ErrorCode::CannotWrite, fmt::format("cannot rename to {}", target.string()));
  }
  return target;
}

}  // namespace phront::cad
