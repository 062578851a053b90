// A patch of triangles into a hole of a surface.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "phront/status.h"
#include "phront/types.h"

namespace phront {

enum class Needles { Allowed, Avoided };  ///< avoided where other triangles would do

/// The n - 2 triangles of least total area over a closed polygon in space, by dynamic programming
/// (Barequet & Sharir 1995), O(n^3). `polygon`: numbers of its corners in `points`; one may come
/// twice. Corners of the triangles run as the polygon does. Empty for n < 3 and where there are
/// none (numbers that are not finite, corners that come twice in every triangle).
[[nodiscard]] std::vector<std::array<Index, 3>> leastAreaTriangles(
    const std::vector<Index>& polygon, const std::vector<Vec3>& points, Needles needles);

/// The point of the surface next to x; empty where there is none.
using ToSurface = std::function<std::optional<Vec3>(const Vec3& x)>;

struct FillOptions {
  double tolerance = 0;    ///< > 0: triangles further off the surface are divided, model units
  double longestSide = 0;  ///< > 0: longer sides inside are divided
  Index maxTriangles = 2000;
};

struct HoleFill {
  std::vector<Vec3> points;  ///< the hole's corners first, in the order given; then those inside
  std::vector<std::array<Index, 3>> triangles;  ///< counter-clockwise where the loops run so
  double deviation = 0;  ///< largest distance of middles of sides and triangles from the surface
};

/// Fills a hole with one or more loops of corners (straight sides between them). All loops run so
/// that the hole is on their left. Least area first (Barequet & Sharir 1995; loops of one hole are
/// joined by bridges), then finer where it is off the surface (Liepa, "Filling holes in meshes",
/// 2003, with points taken to the surface in place of fairing). Sides of the loops are not divided.
/// Fails with InvalidArgument (fewer than three corners, bad numbers), ResourceLimit (more than 600
/// corners), Failed (no triangles).
[[nodiscard]] Result<HoleFill> fillHole(const std::vector<std::vector<Vec3>>& loops,
                                        const ToSurface& toSurface, const FillOptions& options);

}  // namespace phront
