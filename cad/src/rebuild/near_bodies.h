// Which bodies of a model are offset together.
#pragma once

#include <string>
#include <vector>

#include "phront/cad/shape.h"

namespace phront::cad {

/// The bodies that offsetting by d works on, one by one. Growing solids whose fronts meet (nearer
/// than 2d to each other, touching ones included) become one body, a compound of theirs: the
/// offset of the whole is their union. All other bodies are as they were, in their order. Says in
/// `warnings` what was put together.
[[nodiscard]] std::vector<Body> joinNearBodies(const std::vector<Body>& bodies, double distance,
                                               std::vector<std::string>& warnings);

}  // namespace phront::cad
