// Fast marching (Sethian 1996) with a binary heap, first order.
#pragma once

#include <vector>

#include "problems.h"

namespace phront::bench {

[[nodiscard]] std::vector<double> fastMarching(const SphereProblem& problem);

}  // namespace phront::bench
