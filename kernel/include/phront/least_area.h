// Triangles over closed polygons in space.
#pragma once

#include <array>
#include <set>
#include <utility>
#include <vector>

#include "phront/types.h"

namespace phront {

/// Triangles whose corners lie in line: avoided where others would do, even larger ones.
enum class Flat { Allowed, Avoided };

/// Sides that are there already, as smaller and larger corner: no triangle gets one.
using TakenSides = std::set<std::pair<Index, Index>>;

/// The n - 2 triangles of least total area over a closed polygon in space, by dynamic programming
/// (Barequet & Sharir 1995), O(n^3). `polygon`: numbers of its corners in `points`; one may come
/// twice. Corners of the triangles run as the polygon does. Empty for n < 3 and where there are
/// none (numbers that are not finite, corners that come twice in every triangle, sides all taken).
/// The polygon's own sides may be among those taken.
[[nodiscard]] std::vector<std::array<Index, 3>> leastAreaTriangles(
    const std::vector<Index>& polygon, const std::vector<Vec3>& points, Flat flat,
    const TakenSides& taken = {});

/// Loops of one hole as a single polygon for leastAreaTriangles(): each is joined to the nearest
/// one by a side that is used in both directions; corners at the same place are not joined. All run
/// so that the hole is on their left. Not empty; numbers of corners in `points`.
[[nodiscard]] std::vector<Index> joinLoops(const std::vector<std::vector<Index>>& loops,
                                           const std::vector<Vec3>& points);

}  // namespace phront
