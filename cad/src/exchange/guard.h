// The fence around OpenCASCADE: it throws, prints, recurses without end, loops and segfaults.
// Whatever may do that runs in a forked child; only bytes come back.
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "phront/status.h"

namespace phront::cad {

struct GuardLimits {
  double seconds = 30;      ///< wall clock; the child is killed after
  double memoryMiB = 4096;  ///< address space on top of what the parent has mapped
};

/// Runs `work` in a forked child and returns the bytes it returns. An exception, a signal, an exit,
/// the time limit or the memory limit becomes an Error whose sentence starts with `what`
/// ("reading part.step"). The child prints nothing (stdout, stderr and OpenCASCADE's messenger are
/// silenced), runs on a large stack, starts no thread and must not touch files but through `work`.
/// If the parent dies, the child dies. Several threads may guard at once.
[[nodiscard]] Result<std::string> runInChild(const std::string& what, const GuardLimits& limits,
                                             const std::function<Result<std::string>()>& work);

/// Whether this process is such a child, or one's.
[[nodiscard]] bool isGuardedChild();

/// While it lives, children that this thread waits for are killed as soon as `cancelled` is set,
/// and none is started any more: runInChild then fails with Cancelled. Not to be nested.
class CancelScope {
 public:
  explicit CancelScope(const std::atomic<bool>& cancelled);
  CancelScope(const CancelScope&) = delete;
  CancelScope& operator=(const CancelScope&) = delete;
  ~CancelScope();
};

/// Calls `work` in this process, turning Standard_Failure and std::exception into an Error. For
/// calls that may throw but are known neither to hang nor to crash.
template <class Work>
auto guardOcct(const std::string& what, Work&& work) -> decltype(work());

/// Error made from the exception being handled. Call it in a catch (...) block.
[[nodiscard]] Error errorFromCurrentException(const std::string& what);

template <class Work>
auto guardOcct(const std::string& what, Work&& work) -> decltype(work()) {
  try {
    return work();
  } catch (...) {
    return tl::unexpected<Error>(errorFromCurrentException(what));
  }
}

}  // namespace phront::cad
