// Polygons in the plane: what every planar curve becomes before the field sees it.
#pragma once

#include <array>
#include <vector>

#include "phront/types.h"

namespace phront {

/// Directed segments over shared points. Material lies to their left: a counter-clockwise loop
/// bounds a disc of material, a clockwise one a hole.
struct CurveMesh {
  std::vector<Vec2> points;                    ///< n points, model units
  std::vector<std::array<Index, 2>> segments;  ///< m segments, from and to, indices into `points`
  std::vector<Index> curveOf;                  ///< m, curve of each segment; empty: all 0

  [[nodiscard]] Index curve(Index segment) const {
    return curveOf.empty() ? 0 : curveOf[static_cast<std::size_t>(segment)];
  }
};

/// Curves that `curveOf` tells apart.
[[nodiscard]] Index curveCount(const CurveMesh& mesh);

/// One closed loop (or open line) over the points in their order.
[[nodiscard]] CurveMesh curveThrough(std::vector<Vec2> points, bool closed);

/// Both, numbered one after the other; curves of `b` are numbered on.
[[nodiscard]] CurveMesh joined(const CurveMesh& a, const CurveMesh& b);

/// Area to the left of closed curves, positive when counter-clockwise (model units squared).
[[nodiscard]] double signedArea(const CurveMesh& mesh);

/// Sum of the lengths of all segments (model units).
[[nodiscard]] double length(const CurveMesh& mesh);

}  // namespace phront
