// The check of one body's offset before it is offered.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "judge/check_sampling.h"
#include "phront/cad/check.h"
#include "phront/cad/offset_shape.h"

namespace phront::cad {

/// Samples of a check before a result is offered: kCheckStrictness leaves room for their noise. The
/// user's own check takes more.
inline constexpr int kOfferedSamples = 6000;

/// Of a result as it comes back from a file.
struct FileCheck {
  CheckResult check;
  std::size_t fingerprint = 0;  ///< of what was checked (fingerprintOf); 0: check the file again
};

/// Checks results against one body, as read. A check that fails to come about is a check that does
/// not pass. Several threads may check at once.
class BodyCheck {
 public:
  /// `phi` is the distance of `healed`, made from `body`: it serves where that is the body itself,
  /// else the body is tessellated within `seconds`. Fails as distanceOf().
  [[nodiscard]] static Result<BodyCheck> make(const Body& body, const Body& healed,
                                              std::shared_ptr<const TrueDistance> phi,
                                              double distance, double seconds);

  /// Within `seconds`. An empty result asks "is the true offset empty?".
  [[nodiscard]] CheckResult inMemory(const std::vector<Body>& result, const OffsetOptions& options,
                                     double seconds) const;
  /// The same of what any other program gets, tessellated as it would be there, too.
  [[nodiscard]] FileCheck fromFile(const std::vector<Body>& result, const OffsetOptions& options,
                                   double seconds) const;

 private:
  explicit BodyCheck(ModelDistance in) : in_(std::move(in)) {}
  [[nodiscard]] CheckResult check(const Model& out, const CheckOptions& options) const;

  ModelDistance in_;
};

/// How a result for these options is checked before it is offered.
[[nodiscard]] CheckOptions offeredCheck(const OffsetOptions& options, double seconds);

/// A check that does not pass for this reason.
[[nodiscard]] CheckResult failedCheck(std::string reason);

}  // namespace phront::cad
