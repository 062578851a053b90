// Idea: every few seconds the process forks. The new one goes on, the old one keeps the state of
// that moment and watches. When the worker hangs in a step or dies of it, the watcher ends it,
// notes the step and goes on itself from where it is, leaving that step out. When the worker ends
// well it has sent its result through the pipe that all of them share, and the watchers end, too.
// Copying is cheap: pages are shared until written. Killing the first of the chain, as runInChild
// does when time is up, kills all: each dies with its parent.
#include "exchange/hang_fence.h"

#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <new>

#include "exchange/guard.h"

namespace phront::cad {
namespace {

constexpr double kBetweenSplits = 3;  // s of processor time
constexpr int kPollMs = 20;

double secondsOf(clockid_t clock) {
  timespec time{};
  if (::clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double ownSeconds() { return secondsOf(CLOCK_PROCESS_CPUTIME_ID); }

double secondsOfProcess(pid_t process) {
  clockid_t clock{};
  return ::clock_getcpuclockid(process, &clock) == 0 ? secondsOf(clock) : 0;
}

/// Ends as the worker did.
[[noreturn]] void endAs(int status) {
  if (WIFSIGNALED(status)) ::kill(::getpid(), WTERMSIG(status));
  ::_exit(WIFEXITED(status) ? WEXITSTATUS(status) : 1);
}

}  // namespace

/// Written by the worker.
struct HangFence::Shared {
  std::atomic<pid_t> worker{0};
  std::atomic<std::int64_t> step{-1};  ///< -1: between steps
  std::atomic<double> entered{0};      ///< processor seconds of the worker
};

HangFence::HangFence(double seconds) : seconds_(seconds), lastSplit_(-kBetweenSplits) {
  if (!isGuardedChild()) return;
  void* memory =
      ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory != MAP_FAILED) shared_ = new (memory) Shared;
}

HangFence::~HangFence() {
  rest();
  if (shared_ != nullptr) ::munmap(shared_, sizeof(Shared));
}

void HangFence::rest() {
  if (shared_ != nullptr) shared_->step = -1;
}

bool HangFence::enter() {
  ++step_;
  if (shared_ == nullptr) return true;
  rest();
  if (ownSeconds() - lastSplit_ >= kBetweenSplits) split();
  if (leftOut_.contains(step_)) return false;
  shared_->entered = ownSeconds();
  shared_->step = step_;
  return true;
}

void HangFence::split() {
  for (;;) {
    const pid_t watcher = ::getpid();
    const pid_t worker = ::fork();
    if (worker > 0) {
      leftOut_.insert(watch(worker));
      continue;
    }
    if (worker == 0) {
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (::getppid() != watcher) ::_exit(1);
    }
    lastSplit_ = ownSeconds();
    shared_->worker = ::getpid();
    return;
  }
}

std::int64_t HangFence::watch(pid_t worker) {
  const int handle = static_cast<int>(::syscall(SYS_pidfd_open, worker, 0));
  pollfd entry{handle, POLLIN, 0};
  const auto inStep = [&] { return shared_->worker == worker && shared_->step >= 0; };
  int status = 0;
  for (;;) {
    ::poll(&entry, 1, kPollMs);
    const pid_t ended = ::waitpid(worker, &status, WNOHANG);
    if (ended < 0 && errno != EINTR) ::_exit(1);
    if (ended == worker) {
      if (!WIFSIGNALED(status) || !inStep()) endAs(status);
      break;
    }
    if (inStep() && secondsOfProcess(worker) - shared_->entered > seconds_) {
      ::kill(worker, SIGKILL);
      while (::waitpid(worker, &status, 0) < 0 && errno == EINTR) {
      }
      break;
    }
  }
  const std::int64_t fatal = shared_->step;
  if (handle >= 0) ::close(handle);
  shared_->step = -1;
  return fatal;
}

}  // namespace phront::cad
