#include "phront/cad/offset_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include <TopLoc_Location.hxx>
#include <TopoDS_Shape.hxx>

#include "add_times.h"
#include "carry_marks.h"
#include "deadline.h"
#include "judge/check_body.h"
#include "phront/cad/shape_occt.h"
#include "rebuild/body_offset.h"
#include "rebuild/near_bodies.h"
#include "request.h"
#include "write_checked.h"

namespace phront::cad {
namespace {

// Of the time left, for the bodies; the rest is for the check of the whole.
constexpr double kBodiesShare = 0.8;
constexpr double kLeastBodySeconds = 2;
// A second go at bodies that failed is worth it with so much time left.
constexpr double kWorthSeconds = 5;
// Bodies with faults: mostly in vain, so not for long.
constexpr double kInvalidBodySeconds = 12;
constexpr double kLeastCheckSeconds = 10;

// An instance of the same part as body i before it: assemblies place one shape many times.
std::optional<std::size_t> earlierTwin(const std::vector<Body>& bodies, std::size_t i) {
  const TopoDS_Shape& shape = occtShape(bodies[i].shape);
  for (std::size_t j = 0; j < i; ++j) {
    const TopoDS_Shape& other = occtShape(bodies[j].shape);
    if (bodies[j].kind == bodies[i].kind && !shape.IsNull() && !other.IsNull() &&
        shape.IsPartner(other) && shape.Orientation() == other.Orientation()) {
      return j;
    }
  }
  return std::nullopt;
}

// What was done for body `from`, moved to where its twin `to` is.
BodyOffset movedTo(const Body& to, const Body& from, std::size_t fromIndex, BodyOffset offset) {
  const TopLoc_Location move =
      occtShape(to.shape).Location() * occtShape(from.shape).Location().Inverted();
  for (Body& body : offset.bodies) {
    body.name = to.name;
    body.shape = makeShape(occtShape(body.shape).Moved(move));
  }
  offset.report.name = to.name;
  offset.report.attempts = {fmt::format("the same part as body {}, moved", fromIndex + 1)};
  offset.times.clear();
  return offset;
}

double weightOf(const Body& body) {
  constexpr double kOverhead = 5;  // faces' worth of what every body costs
  return faceCount(body.shape) + kOverhead;
}

/// Offsets bodies one by one within a time that they share.
class BodiesOffset {
 public:
  BodiesOffset(const std::vector<Body>& bodies, const OffsetOptions& options, double seconds,
               const Progress& progress)
      : bodies_(bodies),
        options_(options),
        deadline_(seconds),
        progress_(progress),
        twin_(bodies.size()),
        offsets_(bodies.size()) {
    for (std::size_t i = 0; i < bodies.size(); ++i) twin_[i] = earlierTwin(bodies, i);
  }

  Result<std::vector<BodyOffset>> run() {
    std::vector<std::size_t> todo;
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      if (!twin_[i]) todo.push_back(i);
    if (Result<void> done = offset(todo); !done) return tl::unexpected(done.error());
    // Shares by faces are a guess: those that failed for want of time get what others left.
    std::vector<std::size_t> again;
    for (const std::size_t i : todo)
      if (offsets_[i].report.kind == OffsetKind::Failed && bodies_[i].valid) again.push_back(i);
    if (todo.size() > 1 && !again.empty() && deadline_.left() > kWorthSeconds) {
      if (Result<void> done = offset(again); !done) return tl::unexpected(done.error());
    }
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      if (twin_[i])
        offsets_[i] = movedTo(bodies_[i], bodies_[*twin_[i]], *twin_[i], offsets_[*twin_[i]]);
    return std::move(offsets_);
  }

 private:
  Result<void> offset(const std::vector<std::size_t>& todo) {
    double weightLeft = 0;
    for (const std::size_t i : todo) weightLeft += weightOf(bodies_[i]);
    for (std::size_t k = 0; k < todo.size(); ++k) {
      const Body& body = bodies_[todo[k]];
      OffsetOptions options = options_;
      options.timeLimit =
          deadline_.forStep(weightOf(body) / weightLeft, kLeastBodySeconds, options_.timeLimit);
      if (!body.valid) options.timeLimit = std::min(options.timeLimit, kInvalidBodySeconds);
      weightLeft -= weightOf(body);
      const double count = static_cast<double>(todo.size());
      Result<BodyOffset> made = offsetBody(
          body, options,
          progress_.part(static_cast<double>(k) / count, static_cast<double>(k + 1) / count));
      if (!made) return tl::unexpected(made.error());
      if (!body.valid && made->report.kind == OffsetKind::Failed) {
        return fail(ErrorCode::UnreadableInput,
                    fmt::format("body {}{} is not valid (OpenCASCADE's check) and has no offset "
                                "that passes: repair it in the CAD system it comes from",
                                todo[k] + 1, body.name.empty() ? "" : " '" + body.name + "'"));
      }
      BodyOffset& best = offsets_[todo[k]];
      std::vector<StageTime> times = best.times;
      addTimes(times, made->times);
      if (best.bodies.empty() || made->report.kind != OffsetKind::Failed) best = std::move(*made);
      best.times = std::move(times);
    }
    return {};
  }

  const std::vector<Body>& bodies_;
  const OffsetOptions& options_;
  Deadline deadline_;
  const Progress& progress_;
  std::vector<std::optional<std::size_t>> twin_;
  std::vector<BodyOffset> offsets_;
};

// A mitre was asked for, and somewhere there is none.
void tellRounded(const BodyReport& body, const OffsetOptions& options,
                 std::vector<std::string>& warnings) {
  if (body.roundedFaces == 0) return;
  const std::string who = body.name.empty() ? "" : " of '" + body.name + "'";
  warnings.push_back(fmt::format(
      "{} face(s){} round edges and corners stay round: their mitre would reach farther than {:g} "
      "|d|, or could not be made",
      body.roundedFaces, who, options.mitreLimit));
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
  options.join = report.options.join;
  options.mitreLimit = report.options.mitreLimit;
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
                         "the whole");
  return whole;
}

}  // namespace

Result<OffsetResult> offsetModel(const Model& model, const OffsetOptions& requested,
                                 const Progress& progress) {
  const Result<double> tolerance =
      checkedTolerance(model, requested.distance, requested.tolerance, requested.timeLimit);
  if (!tolerance) return tl::unexpected(tolerance.error());
  if (!(requested.mitreLimit > 1) || !std::isfinite(requested.mitreLimit))
    return fail(ErrorCode::InvalidArgument, "the mitre limit must be a number above 1");
  OffsetOptions options = requested;
  options.tolerance = *tolerance;
  OffsetResult result;
  OffsetReport& report = result.report;
  report.options = options;
  report.warnings = model.warnings;
  result.model.assemblies = model.assemblies;
  const Deadline deadline(options.timeLimit);
  const std::vector<Body> bodies = joinNearBodies(model.bodies, options.distance, report.warnings);
  const Progress forBodies = progress.part(0, 0.95);
  Result<std::vector<BodyOffset>> offsets =
      BodiesOffset(bodies, options,
                   deadline.left() * (model.bodies.size() > 1 ? kBodiesShare : 1), forBodies)
          .run();
  if (!offsets) return tl::unexpected(offsets.error());
  for (std::size_t b = 0; b < offsets->size(); ++b) {
    BodyOffset& offset = (*offsets)[b];
    carryMarks(bodies[b], options.distance, offset.bodies);
    if (offset.report.reach < 1)
      report.warnings.push_back(
          fmt::format("parts of the offset just touch, lose their width or do not cut one another "
                      "cleanly at this distance: it is made at {:g} of it",
                      offset.report.reach));
    tellRounded(offset.report, options, report.warnings);
    for (Body& body : offset.bodies) result.model.bodies.push_back(std::move(body));
    addTimes(report.times, offset.times);
    report.bodies.push_back(std::move(offset.report));
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
  const OffsetOptions& made = result.report.options;
  const Recheck recheck = [&](const Model& back, double seconds) {
    return checkOffset(in, back, offeredCheck(made, seconds));
  };
  // Bodies that were offset together were checked together; apart they are judged otherwise.
  const std::vector<BodyReport>& bodies = result.report.bodies;
  const bool single = in.bodies.size() == 1 && bodies.size() == 1;
  const std::size_t checked = single ? bodies.front().checkedFile : 0;
  return writeChecked(result.model, {path, keep, made.timeLimit, result.report.times, checked},
                      recheck, result.report.check);
}

}  // namespace phront::cad
