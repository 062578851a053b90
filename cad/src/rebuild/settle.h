// Pieces whose samples do not tell whether they lie on the offset.
#pragma once

#include <vector>

#include "rebuild/select.h"

namespace phront::cad {

/// Turns doubtful pieces live or dead, one by one or in groups that hang together, as long as that
/// leaves fewer edges open. Doubtful are pieces within 0.5 % of |distance| of the level, small ones
/// within 3 %, and those of which only some samples are on it. Live pieces are only taken away
/// where three or more meet at an edge. Returns how many it turned.
int settleDoubtful(std::vector<JudgedFace>& faces, double distance);

}  // namespace phront::cad
