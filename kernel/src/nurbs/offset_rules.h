// What offsets of curves and of surfaces have in common.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "phront/offset_nurbs.h"

namespace phront {

inline constexpr double kTighter = 0.85;  // of the tolerance for the knots, when it was missed
inline constexpr int kMostTightenings = 20;
inline constexpr double kExact = 1e-11;      // of the size and |d|: nothing to be gained beyond
inline constexpr std::size_t kPrunable = 4;  // times the fewest poles: no use to begin with more
inline constexpr int kClimbs = 40;           // steps to a largest error
/// 1 + d k, of a surface the product of both: below, no way back along normals is asked for.
inline constexpr double kFarFromFold = 0.25;

[[nodiscard]] Result<void> checkOptions(const NurbsOffsetOptions& options);
[[nodiscard]] tl::unexpected<Error> tooManyPoles(const NurbsOffsetOptions& options);

inline std::size_t polesIn(const CurveOffset& offset) { return offset.curve.poles.size(); }
inline std::size_t polesIn(const SurfaceOffset& offset) { return offset.surface.poles.size(); }

/// Fewer poles are better, of as many those with the smaller error; errors below `exact` are none.
template <class Offset>
void keepBetter(std::optional<Offset>& best, std::optional<Offset> other, double exact) {
  if (!other) return;
  const auto rank = [exact](const Offset& offset) {
    return std::pair(polesIn(offset), std::max(offset.error, exact));
  };
  if (!best || rank(*other) < rank(*best)) best = std::move(other);
}
/// Degrees worth trying for curves of a degree, itself first: higher ones need fewer poles where
/// all is smooth, lower ones where it is flat.
[[nodiscard]] std::vector<int> degreesFor(int degree);

/// Largest value of f found by climbing from a parameter within [low, high].
template <class F>
double largestNear(const F& f, double t, double step, double low, double high) {
  double most = f(t);
  for (int i = 0; i < kClimbs; ++i) {
    const double before = std::max(low, t - step);
    const double after = std::min(high, t + step);
    const double a = f(before);
    const double b = f(after);
    if (a > most || b > most) {
      t = a > b ? before : after;
      most = std::max(a, b);
    } else {
      step /= 2;
    }
  }
  return most;
}

}  // namespace phront
