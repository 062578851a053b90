// Idea: fork. A child process shares nothing that it could spoil, can be killed when it hangs, and
// may die of any signal; a pipe brings its bytes home. Details that measurements and manuals ask
// for:
// - the work runs on its own large stack (makecontext), so that deep but finite recursion succeeds
// and
//   endless recursion still hits a guard page within a fraction of a second;
// - all inherited descriptors but the pipe are closed, else a child forked by another thread at the
//   same moment would hold our pipe open;
// - RLIMIT_AS counts what the parent has mapped (oneTBB, shared libraries), so the limit is put on
// top;
// - PR_SET_PDEATHSIG kills the child with the thread that waits for it.
// Weak spots: a lock that another thread holds inside OpenCASCADE at the moment of the fork stays
// locked in the child; the time limit then ends it. malloc is safe (glibc re-initialises it).
#include "exchange/guard.h"

#include <fcntl.h>
#include <fenv.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <ucontext.h>
#include <unistd.h>

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Standard_Failure.hxx>
#include <Standard_OutOfMemory.hxx>
#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

namespace phront::cad {
namespace {

using Clock = std::chrono::steady_clock;

// Deep enough for OpenCASCADE's recursive graph walks on large files, small enough to overflow
// fast.
constexpr std::size_t kStackBytes = std::size_t{256} << 20;
constexpr std::size_t kGuardBytes = std::size_t{64} << 10;
constexpr std::size_t kMiB = std::size_t{1} << 20;
// How often the parent looks whether the child is gone though its pipe is not closed, or not
// needed.
constexpr int kPollMs = 20;
// CPU seconds beyond the wall-clock limit: only a second net, should the parent not kill.
constexpr rlim_t kCpuSlack = 5;

enum class Outcome : std::uint32_t { Bytes, Error, OutOfMemory };

bool guarded = false;  // in a child

struct FrameHeader {
  std::uint32_t magic = 0x70687267;
  Outcome outcome = Outcome::Bytes;
  std::int32_t code = 0;
  std::uint32_t padding = 0;
  std::uint64_t messageSize = 0;
  std::uint64_t whereSize = 0;
  std::uint64_t payloadSize = 0;
};

// ---- child ----------------------------------------------------------------------------------

bool writeAll(int fd, const void* data, std::size_t size) {
  const char* bytes = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t n = ::write(fd, bytes, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

struct ChildJob {
  const std::string* what;
  const std::function<Result<std::string>()>* work;
  int pipe;
};

void sendFrame(int fd, Outcome outcome, const Error& error, const std::string& payload) {
  FrameHeader header;
  header.outcome = outcome;
  header.code = static_cast<std::int32_t>(error.code);
  header.messageSize = error.message.size();
  header.whereSize = error.where.size();
  header.payloadSize = payload.size();
  (void)(writeAll(fd, &header, sizeof header) &&
         writeAll(fd, error.message.data(), error.message.size()) &&
         writeAll(fd, error.where.data(), error.where.size()) &&
         writeAll(fd, payload.data(), payload.size()));
}

[[noreturn]] void runJob(const ChildJob& job) {
  try {
    Message::DefaultMessenger()->ChangePrinters().Clear();
    const Result<std::string> result = (*job.work)();
    if (result) {
      sendFrame(job.pipe, Outcome::Bytes, {}, *result);
    } else {
      sendFrame(job.pipe, Outcome::Error, result.error(), {});
    }
  } catch (const std::bad_alloc&) {
    sendFrame(job.pipe, Outcome::OutOfMemory, {}, {});
  } catch (const Standard_OutOfMemory&) {
    sendFrame(job.pipe, Outcome::OutOfMemory, {}, {});
  } catch (...) {
    sendFrame(job.pipe, Outcome::Error, errorFromCurrentException(*job.what), {});
  }
  ::_exit(0);
}

// makecontext passes ints only: the pointer travels in two halves.
void trampoline(unsigned high, unsigned low) {
  const auto address = (static_cast<std::uintptr_t>(high) << 32) | low;
  runJob(*reinterpret_cast<const ChildJob*>(address));
}

[[noreturn]] void runOnLargeStack(const ChildJob& job) {
  void* stack = ::mmap(nullptr, kStackBytes, PROT_READ | PROT_WRITE,
                       MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_STACK, -1, 0);
  ucontext_t context;
  if (stack == MAP_FAILED || ::mprotect(stack, kGuardBytes, PROT_NONE) != 0 ||
      ::getcontext(&context) != 0) {
    runJob(job);
  }
  context.uc_stack.ss_sp = stack;
  context.uc_stack.ss_size = kStackBytes;
  context.uc_link = nullptr;
  const auto address = reinterpret_cast<std::uintptr_t>(&job);
  ::makecontext(&context, reinterpret_cast<void (*)()>(trampoline), 2,
                static_cast<unsigned>(address >> 32), static_cast<unsigned>(address));
  ::setcontext(&context);
  ::_exit(1);
}

std::size_t mappedBytes() {
  std::size_t pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "re")) {
    if (std::fscanf(file, "%zu", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

void lowerLimit(__rlimit_resource resource, rlim_t value) {
  rlimit limit{};
  if (::getrlimit(resource, &limit) != 0) return;
  if (limit.rlim_max != RLIM_INFINITY) value = std::min(value, limit.rlim_max);
  limit.rlim_cur = value;
  ::setrlimit(resource, &limit);
}

void limitResources(const GuardLimits& limits) {
  ::prctl(PR_SET_DUMPABLE, 0);
  lowerLimit(RLIMIT_CORE, 0);
  lowerLimit(RLIMIT_CPU, static_cast<rlim_t>(std::ceil(limits.seconds)) + kCpuSlack);
  const double budget = std::clamp(limits.memoryMiB, 1.0, 1e9) * static_cast<double>(kMiB);
  lowerLimit(RLIMIT_AS, mappedBytes() + kStackBytes + static_cast<rlim_t>(budget));
}

// The parent's handlers (of a GUI, of OSD::SetSignal) would run in a process they know nothing of.
void resetSignals() {
  for (int signal = 1; signal < NSIG; ++signal) {
    struct sigaction standard {};
    standard.sa_handler = SIG_DFL;
    ::sigaction(signal, &standard, nullptr);
  }
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  stack_t noAlternate{};
  noAlternate.ss_flags = SS_DISABLE;
  ::sigaltstack(&noAlternate, nullptr);
  ::fedisableexcept(FE_ALL_EXCEPT);
}

[[noreturn]] void childMain(const std::string& what, const GuardLimits& limits,
                            const std::function<Result<std::string>()>& work, int pipe,
                            pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);
  resetSignals();
  pipe = ::fcntl(pipe, F_DUPFD, 3);  // a parent without stdin may have it below 3
  const int null = ::open("/dev/null", O_RDWR);
  for (int fd = 0; fd < 3; ++fd) ::dup2(null, fd);
  constexpr int kPipe = 3;
  ::dup2(pipe, kPipe);
  ::close_range(kPipe + 1, ~0U, 0);
  limitResources(limits);
  guarded = true;
  runOnLargeStack(ChildJob{&what, &work, kPipe});
}

// ---- parent ---------------------------------------------------------------------------------

thread_local const std::atomic<bool>* cancelFlag = nullptr;  // of the thread's CancelScope

bool isCancelled() { return cancelFlag != nullptr && cancelFlag->load(std::memory_order_relaxed); }

struct Collected {
  std::string bytes;
  int status = 0;  // of waitpid
  bool haveStatus = false;
  bool timedOut = false;
  bool cancelled = false;
};

bool reap(pid_t child, int options, Collected& collected) {
  pid_t got = 0;
  do {
    got = ::waitpid(child, &collected.status, options);
  } while (got < 0 && errno == EINTR);
  collected.haveStatus = got == child;
  return got != 0;
}

// True while the pipe may bring more.
bool drain(int fd, std::string& bytes) {
  std::array<char, 1 << 16> buffer;
  for (;;) {
    const ssize_t n = ::read(fd, buffer.data(), buffer.size());
    if (n > 0) {
      bytes.append(buffer.data(), static_cast<std::size_t>(n));
    } else if (n == 0) {
      return false;
    } else if (errno != EINTR) {
      return errno == EAGAIN;
    }
  }
}

Collected collect(pid_t child, int fd, const GuardLimits& limits) {
  Collected collected;
  const auto deadline =
      Clock::now() + std::chrono::duration<double>(std::clamp(limits.seconds, 0.0, 1e6));
  for (;;) {
    const double left = std::chrono::duration<double>(deadline - Clock::now()).count();
    collected.cancelled = isCancelled();
    collected.timedOut = left <= 0;
    if (collected.cancelled || collected.timedOut) break;
    pollfd entry{fd, POLLIN, 0};
    ::poll(&entry, 1, std::min(kPollMs, static_cast<int>(std::ceil(left * 1000))));
    if (!drain(fd, collected.bytes)) break;
    if (reap(child, WNOHANG, collected)) {
      drain(fd, collected.bytes);
      return collected;
    }
  }
  // Past its time, not needed, or its pipe is closed: all is sent, or it is dying.
  if (collected.timedOut || collected.cancelled) ::kill(child, SIGKILL);
  reap(child, 0, collected);
  return collected;
}

std::string signalSentence(int signal) {
  switch (signal) {
    case SIGSEGV:
      return "segmentation fault";
    case SIGBUS:
      return "bus error";
    case SIGFPE:
      return "arithmetic fault";
    case SIGILL:
      return "illegal instruction";
    case SIGABRT:
      return "abort";
    default:
      return fmt::format("signal {}", signal);
  }
}

Error cancelError(const std::string& what) {
  return {ErrorCode::Cancelled, what + " was cancelled", {}};
}

Error timeError(const std::string& what, const GuardLimits& limits) {
  return {ErrorCode::ResourceLimit,
          fmt::format("{} did not finish within {:g} s", what, limits.seconds),
          {}};
}

Error memoryError(const std::string& what, const GuardLimits& limits) {
  return {ErrorCode::ResourceLimit,
          fmt::format("{} needs more than {:g} MiB of memory", what, limits.memoryMiB),
          {}};
}

Error deathError(const std::string& what, const GuardLimits& limits, const Collected& collected) {
  if (collected.haveStatus && WIFSIGNALED(collected.status)) {
    const int signal = WTERMSIG(collected.status);
    if (signal == SIGXCPU) return timeError(what, limits);
    if (signal == SIGINT || signal == SIGTERM) {
      return {ErrorCode::Cancelled, what + " was interrupted", {}};
    }
    if (signal == SIGKILL) {
      return {ErrorCode::ResourceLimit,
              what + " was killed by the system, probably for want of memory",
              {}};
    }
    return {ErrorCode::Failed,
            fmt::format("{}: OpenCASCADE crashed ({})", what, signalSentence(signal)),
            {}};
  }
  return {ErrorCode::Failed, what + ": OpenCASCADE ended the process", {}};
}

Result<std::string> decode(const std::string& what, const GuardLimits& limits,
                           const Collected& collected) {
  FrameHeader header;
  const FrameHeader expected;
  const std::string& bytes = collected.bytes;
  if (bytes.size() >= sizeof header) std::memcpy(&header, bytes.data(), sizeof header);
  const bool complete =
      bytes.size() >= sizeof header && header.magic == expected.magic &&
      bytes.size() == sizeof header + header.messageSize + header.whereSize + header.payloadSize;
  if (!complete) {
    if (collected.cancelled) return tl::unexpected<Error>(cancelError(what));
    if (collected.timedOut) return tl::unexpected<Error>(timeError(what, limits));
    return tl::unexpected<Error>(deathError(what, limits, collected));
  }
  const std::size_t message = sizeof header;
  const std::size_t where = message + header.messageSize;
  switch (header.outcome) {
    case Outcome::Bytes:
      return bytes.substr(where + header.whereSize);
    case Outcome::OutOfMemory:
      return tl::unexpected<Error>(memoryError(what, limits));
    case Outcome::Error:
      break;
  }
  return fail(static_cast<ErrorCode>(header.code), bytes.substr(message, header.messageSize),
              bytes.substr(where, header.whereSize));
}

}  // namespace

Result<std::string> runInChild(const std::string& what, const GuardLimits& limits,
                               const std::function<Result<std::string>()>& work) {
  if (!(limits.seconds > 0) || !(limits.memoryMiB > 0)) {
    return fail(ErrorCode::InvalidArgument, what + ": time and memory limit must be positive");
  }
  if (isCancelled()) return tl::unexpected<Error>(cancelError(what));
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) {
    return fail(ErrorCode::ResourceLimit, what + ": no free file descriptor for a child process");
  }
  ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  ::fcntl(ends[1], F_SETPIPE_SZ, static_cast<int>(kMiB));
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child == 0) {
    childMain(what, limits, work, ends[1], parent);
  }
  ::close(ends[1]);
  if (child < 0) {
    ::close(ends[0]);
    return fail(ErrorCode::ResourceLimit, what + ": the system refuses another process");
  }
  const Collected collected = collect(child, ends[0], limits);
  ::close(ends[0]);
  return decode(what, limits, collected);
}

bool isGuardedChild() { return guarded; }

CancelScope::CancelScope(const std::atomic<bool>& cancelled) { cancelFlag = &cancelled; }

CancelScope::~CancelScope() { cancelFlag = nullptr; }

Error errorFromCurrentException(const std::string& what) {
  try {
    throw;
  } catch (const Standard_OutOfMemory&) {
    return {ErrorCode::ResourceLimit, what + " ran out of memory", {}};
  } catch (const Standard_Failure& failure) {
    const char* text = failure.GetMessageString();
    const std::string kind = failure.DynamicType()->Name();
    const std::string detail = text && *text ? kind + ": " + text : kind;
    return {ErrorCode::Failed, fmt::format("{}: OpenCASCADE failed ({})", what, detail), {}};
  } catch (const std::bad_alloc&) {
    return {ErrorCode::ResourceLimit, what + " ran out of memory", {}};
  } catch (const std::exception& exception) {
    return {ErrorCode::Failed, fmt::format("{} failed ({})", what, exception.what()), {}};
  } catch (...) {
    return {ErrorCode::Failed, what + " failed for an unknown reason", {}};
  }
}

}  // namespace phront::cad
