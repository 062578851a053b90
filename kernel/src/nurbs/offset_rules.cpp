#include "nurbs/offset_rules.h"

#include <fmt/format.h>

#include <cmath>

namespace phront {

Result<void> checkOptions(const NurbsOffsetOptions& options) {
  if (!std::isfinite(options.distance)) {
    return fail(ErrorCode::InvalidArgument, "The distance must be a number.", "distance");
  }
  if (!(options.tolerance > 0) || !std::isfinite(options.tolerance)) {
    return fail(ErrorCode::InvalidArgument, "The tolerance must be positive.", "tolerance");
  }
  return {};
}

tl::unexpected<Error> tooManyPoles(const NurbsOffsetOptions& options) {
  return fail(ErrorCode::ResourceLimit,
              fmt::format("The tolerance {:g} asks for more than {} poles; use a coarser one.",
                          options.tolerance, options.maxPoles),
              "tolerance");
}

std::vector<int> degreesFor(int degree) {
  std::vector<int> degrees{degree};
  for (const int other : {3, 5, 7, 2, 1}) {
    if (other != degree) degrees.push_back(other);
  }
  return degrees;
}

}  // namespace phront
