#include "shell/wall_steps.h"

#include <utility>

#include "judge/check_body.h"
#include "rebuild/body_offset.h"

namespace phront::cad {

Result<std::optional<std::vector<Body>>> offsetSide(const Body& body, const SideRequest& side,
                                                    const ShellBodyRequest& request,
                                                    const Progress& progress, BodyShell& made) {
  OffsetOptions options;
  options.distance = side.distance;
  options.tolerance = request.tolerance;
  options.threads = request.threads;
  options.timeLimit = side.seconds;
  Result<BodyOffset> offset = offsetBody(body, options, progress);
  if (!offset) return tl::unexpected(offset.error());
  BodyReport& report = made.report;
  for (const std::string& attempt : offset->report.attempts)
    report.attempts.push_back(side.what + ": " + attempt);
  made.times.insert(made.times.end(), offset->times.begin(), offset->times.end());
  if (offset->report.kind == OffsetKind::Failed) {
    report.kind = OffsetKind::Failed;
    report.check =
        failedCheck(side.what + " cannot be made: " + offset->report.check.reasons.front());
    return std::optional<std::vector<Body>>();
  }
  report.fittedFaces += offset->report.fittedFaces;
  report.facetedFaces += offset->report.facetedFaces;
  report.setting = offset->report.setting;
  return std::optional(std::move(offset->bodies));
}

}  // namespace phront::cad
