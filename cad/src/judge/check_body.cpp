#include "judge/check_body.h"

#include <utility>

namespace phront::cad {

CheckResult failedCheck(std::string reason) {
  CheckResult check;
  check.reasons.push_back(std::move(reason));
  return check;
}

CheckResult checkBody(const Body& body, const std::vector<Body>& result,
                      const OffsetOptions& options, double seconds) {
  Model in;
  in.bodies.push_back(body);
  Model out;
  out.bodies = result;
  CheckOptions check;
  check.distance = options.distance;
  check.tolerance = options.tolerance;
  check.join = options.join;
  check.mitreLimit = options.mitreLimit;
  check.samples = kOfferedSamples;
  check.timeLimit = seconds;
  check.meshPlainly = false;  // the result's file is
  const Result<CheckResult> checked = checkOffset(in, out, check);
  return checked ? *checked : failedCheck(checked.error().message);
}

}  // namespace phront::cad
