// Time that is left, handed down: what one step does not use the next one has; and time spent.
#pragma once

#include <algorithm>
#include <chrono>

namespace phront::cad {

[[nodiscard]] inline double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

class Deadline {
 public:
  explicit Deadline(double seconds)
      : end_(Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                std::chrono::duration<double>(std::clamp(seconds, 0.0, 1e6)))) {}

  /// Seconds, never negative.
  [[nodiscard]] double left() const {
    return std::max(0.0, std::chrono::duration<double>(end_ - Clock::now()).count());
  }
  /// Seconds for a step that may use `share` of what is left, within [least, most].
  [[nodiscard]] double forStep(double share, double least, double most) const {
    return std::clamp(share * left(), least, most);
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point end_;
};

}  // namespace phront::cad
