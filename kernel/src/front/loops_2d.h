// Closed loops of straight sides in a plane: are they simple, and which lies in which?
#pragma once

#include <optional>
#include <vector>

#include "phront/types.h"

namespace phront::facet {

struct Point2d {
  double x = 0;
  double y = 0;
  Index id = kNone;  ///< equal ids are the same point
};
using Loop2d = std::vector<Point2d>;

/// Positive when counter-clockwise.
[[nodiscard]] double signedArea(const Loop2d& loop);

/// No two sides cross, touch or come nearer than `clearance`, but neighbours at their common point;
/// neighbours do not fold back onto one another; no point belongs to two loops.
[[nodiscard]] bool loopsAreSimple(const std::vector<Loop2d>& loops, double clearance);

/// Groups of loop numbers: an outer loop (counter-clockwise), then its holes. Empty when a hole
/// lies in no outer loop. Loops must be simple.
[[nodiscard]] std::optional<std::vector<std::vector<std::size_t>>> nestLoops(
    const std::vector<Loop2d>& loops);

}  // namespace phront::facet
