// Arrival times from a level set that evolves in time (Osher and Sethian 1988).
#pragma once

#include <vector>

#include "problems.h"

namespace phront::bench {

/// psi_t + |grad psi| = 0 by first-order upwind differences in space and time, from the distance
/// known near the sphere; the time of a node is when psi passes 0. Nodes inside: 0.
[[nodiscard]] std::vector<double> levelSetTimes(const SphereProblem& problem);

}  // namespace phront::bench
