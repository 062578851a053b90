#include "request.h"

#include <cmath>

namespace phront::cad {
namespace {

constexpr double kToleranceOfDistance = 0.01;

}  // namespace

Result<double> checkedTolerance(const Model& model, double distance,
                                const std::optional<double>& tolerance, double timeLimit) {
  if (!std::isfinite(distance) || distance == 0)
    return fail(ErrorCode::InvalidArgument,
                "the offset distance must be a finite number other than 0; give -d in mm or with a "
                "unit, for example -d 2 or -d -0.1in");
  if (tolerance && !(*tolerance > 0 && std::isfinite(*tolerance)))
    return fail(ErrorCode::InvalidArgument, "the tolerance must be a positive length");
  if (!(timeLimit > 0))
    return fail(ErrorCode::InvalidArgument, "the time limit must be a positive number of seconds");
  if (model.bodies.empty())
    return fail(ErrorCode::InvalidArgument, "the model holds no body to offset");
  return tolerance.value_or(kToleranceOfDistance * std::abs(distance));
}

}  // namespace phront::cad
