// The distance to a body, fine enough for its offset.
#pragma once

#include "tessellate/true_distance.h"

namespace phront::cad {

/// Tessellates the body (in a guarded child, `seconds` for one try) finely enough for offsets by
/// `distance`, or `fineness` times as fine. Fails with UnreadableInput and a sentence for the user,
/// ResourceLimit.
[[nodiscard]] Result<TrueDistance> distanceOf(const Body& body, double distance, double seconds,
                                              double fineness = 1);

}  // namespace phront::cad
