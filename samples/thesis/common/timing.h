// The split of times that the thesis prints: seed, sweep, iso, advection.
#pragma once

#include <chrono>
#include <string_view>
#include <utility>

#include "common/report.h"
#include "phront/grid_field.h"

namespace thesis {

class Stopwatch {
 public:
  /// Seconds since the lap before, or since the start.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(start_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// A swept field and the seconds it took on one thread.
struct TimedField {
  phront::GridField field;
  double seed = 0;   ///< exact distance at the nodes near the geometry, values laid out in tiles
  double sweep = 0;  ///< all sweeps, and signs
};

/// The Godunov scheme over curves or a surface.
template <class Geometry>
TimedField sweepTimed(const phront::NodeGrid& grid, const Geometry& geometry,
                      phront::EikonalOrder order = phront::EikonalOrder::First) {
  TimedField timed;
  Stopwatch watch;
  // The call names its stages as it goes: the first report of "sweep" ends the seed.
  bool sweeping = false;
  const phront::Progress progress([&](double, std::string_view stage) {
    if (stage == "sweep" && !std::exchange(sweeping, true)) timed.seed = watch.lap();
    return true;
  });
  timed.field = orStop(phront::solveGridField(
      grid, geometry, {.solver = phront::FieldSolver::Godunov, .order = order, .threads = 1},
      progress));
  timed.sweep = watch.lap();
  return timed;
}

}  // namespace thesis
