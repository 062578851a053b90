// A fence round each of many steps of a calculation that cannot be interrupted between them.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <set>

namespace phront::cad {

/// In a child of runInChild: a step that hangs or crashes is left out, and the rest goes on as if
/// it had returned at once. The steps must be the same and in the same order whenever they run.
/// What they have done so far is repeated only since some seconds before, so that even a step
/// at the end costs little. Where the system refuses a process, there is no fence.
class HangFence {
 public:
  /// `seconds`: of processor time that a step may take, > 0.
  explicit HangFence(double seconds);
  HangFence(const HangFence&) = delete;
  HangFence& operator=(const HangFence&) = delete;
  ~HangFence();

  /// To be called before every step. False: the step is to be left out.
  [[nodiscard]] bool enter();

  /// What comes before the next step is not fenced.
  void rest();

 private:
  struct Shared;
  void split();  ///< goes on in a new process, again for every step that ends one
  std::int64_t watch(pid_t worker);  ///< the step that the worker hung in or died of

  Shared* shared_ = nullptr;  ///< memory of this process and those it came from
  double seconds_;
  double lastSplit_;
  std::int64_t step_ = -1;
  std::set<std::int64_t> leftOut_;
};

}  // namespace phront::cad
