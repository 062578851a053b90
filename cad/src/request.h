// What every offset of a model is asked for.
#pragma once

#include <optional>

#include "phront/cad/shape.h"
#include "phront/status.h"

namespace phront::cad {

/// The tolerance to work to, mm: the one given, or 1 % of |distance|. Fails with InvalidArgument
/// and a sentence for the user.
[[nodiscard]] Result<double> checkedTolerance(const Model& model, double distance,
                                              const std::optional<double>& tolerance,
                                              double timeLimit);

}  // namespace phront::cad
