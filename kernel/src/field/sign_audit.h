// Do the signs of a field contradict each other?
#pragma once

#include <cstdint>
#include <vector>

#include "phront/distance_field.h"

namespace phront {

/// Audits the signs of a closed surface's field and repairs them by winding number; the magnitude
/// of phi is never changed. `phi` are the field's values. Returns the number of nodes that were
/// turned.
[[nodiscard]] std::int64_t auditSigns(const SurfaceDistance& surface, const DistanceField& field,
                                      std::vector<double>& phi, int threads);

}  // namespace phront
