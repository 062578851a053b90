// Names and colours on their way from a part to what was made of it.
#pragma once

#include <vector>

#include "phront/cad/shape.h"

namespace phront::cad {

/// Puts `out` into the assembly of `in` and gives every face of `out` the name and colour of the
/// face of `in` that it stems from: that most of its points have their foot on. Roundings of edges
/// get no name, and a colour where all faces at the edge have the same. `distance` (mm, signed):
/// how far the two are apart. Where the feet cannot be found the faces stay unmarked.
void carryMarks(const Body& in, double distance, std::vector<Body>& out);

}  // namespace phront::cad
