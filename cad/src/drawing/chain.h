// Polygonal curves of a drawing on their way to a CurveMesh.
#pragma once

#include <vector>

#include "phront/cad/drawing.h"

namespace phront::cad {

struct Chain {
  std::vector<Vec2> points;  ///< mm; closed ones do not repeat the first point
  bool closed = false;
};

/// Joins open chains whose ends lie nearer to one another than `tolerance`, closes those that come
/// back, drops what has no length or was there before, orients loops by nesting.
[[nodiscard]] Drawing assemble(std::vector<Chain> chains, double tolerance);

/// Points of an arc of an ellipse centre + cos t x + sin t y, t from `from` to `to` (rad), both
/// ends included; chords off by at most `tolerance`.
[[nodiscard]] std::vector<Vec2> ellipseArc(const Vec2& centre, const Vec2& x, const Vec2& y,
                                           double from, double to, double tolerance);

}  // namespace phront::cad
