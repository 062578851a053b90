#include "judge/check_body.h"

#include <utility>

#include "judge/check_against.h"
#include "judge/read_back.h"
#include "phront/cad/shape_occt.h"
#include "tessellate/body_distance.h"

namespace phront::cad {

CheckResult failedCheck(std::string reason) {
  CheckResult check;
  check.reasons.push_back(std::move(reason));
  return check;
}

CheckOptions offeredCheck(const OffsetOptions& options, double seconds) {
  CheckOptions check;
  check.distance = options.distance;
  check.tolerance = options.tolerance;
  check.join = options.join;
  check.mitreLimit = options.mitreLimit;
  check.samples = kOfferedSamples;
  check.timeLimit = seconds;
  return check;
}

Result<BodyCheck> BodyCheck::make(const Body& body, const Body& healed,
                                  std::shared_ptr<const TrueDistance> phi, double distance,
                                  double seconds) {
  if (!occtShape(healed.shape).IsSame(occtShape(body.shape))) {
    Result<TrueDistance> own = distanceOf(body, distance, seconds);
    if (!own) return tl::unexpected(own.error());
    phi = std::make_shared<const TrueDistance>(std::move(*own));
  }
  Result<ModelDistance> in = ModelDistance::of(body, std::move(phi));
  if (!in) return tl::unexpected(in.error());
  return BodyCheck(std::move(*in));
}

CheckResult BodyCheck::check(const Model& out, const CheckOptions& options) const {
  const Result<CheckResult> checked = checkAgainst(in_, out, options);
  return checked ? *checked : failedCheck(checked.error().message);
}

CheckResult BodyCheck::inMemory(const std::vector<Body>& result, const OffsetOptions& options,
                                double seconds) const {
  Model out;
  out.bodies = result;
  CheckOptions check = offeredCheck(options, seconds);
  check.meshPlainly = false;  // the result's file is
  return this->check(out, check);
}

FileCheck BodyCheck::fromFile(const std::vector<Body>& result, const OffsetOptions& options,
                              double seconds) const {
  const Result<std::optional<Model>> back = readBack(result);
  if (!back) return {failedCheck("the result does not survive a file: " + back.error().message), 0};
  if (!*back) return {inMemory(result, options, seconds), 0};
  // Where the input's triangles are not whole, the written file is to be checked against others.
  const bool whole = in_.untessellatedFaces() == 0;
  return {check(**back, offeredCheck(options, seconds)), whole ? fingerprintOf(**back) : 0};
}

}  // namespace phront::cad
