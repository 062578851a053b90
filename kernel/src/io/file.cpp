// Files are read whole and written whole. Writing goes to a new file in the same folder, is flushed
// to the disk and then renamed over the target, so that a reader sees the old file or the new one,
// never half of either. What exists and is no regular file (a pipe, /dev/stdout, /dev/null) cannot
// be replaced by a rename and is written to directly.
#include "io/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "phront/mesh_io.h"

namespace phront {
namespace {

namespace fs = std::filesystem;

/// Closes a file descriptor at the end of its scope.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool closeNow() {
    const int fd = fd_;
    fd_ = -1;
    return ::close(fd) == 0;
  }

 private:
  int fd_;
};

std::string reason() { return std::generic_category().message(errno); }

bool writeAll(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

Result<void> cannotWrite(const fs::path& path) {
  return fail(ErrorCode::CannotWrite, fmt::format("cannot write {}: {}", path.string(), reason()));
}

Result<void> writeDirectly(const fs::path& path, std::string_view bytes) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (file.get() < 0 || !writeAll(file.get(), bytes)) return cannotWrite(path);
  return {};
}

/// Name for the file beside; short, so that a target name of full length does not make it too long.
fs::path nameBeside(const fs::path& target) {
  static std::atomic<unsigned> count{0};  // only makes names differ, never reaches a result
  return target.parent_path() / fmt::format(".phront-{}-{}.tmp", ::getpid(), count++);
}

}  // namespace

Result<void> writeFileAtomically(const fs::path& path, std::string_view bytes) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status)) {
    return fail(ErrorCode::CannotWrite,
                fmt::format("cannot write {}: it is a folder", path.string()));
  }
  if (fs::exists(status) && !fs::is_regular_file(status)) return writeDirectly(path, bytes);

  // A link keeps being a link: what it points to is replaced.
  fs::path target = path;
  if (fs::is_symlink(fs::symlink_status(path, ignored))) {
    const fs::path resolved = fs::weakly_canonical(path, ignored);
    if (!ignored) target = resolved;
  }

  fs::path beside;
  int fd = -1;
  constexpr int kTries = 100;  // left-over files of a killed process with our id may be in the way
  for (int i = 0; i < kTries && fd < 0; ++i) {
    beside = nameBeside(target);
    fd = ::open(beside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0 && errno != EEXIST) break;
  }
  if (fd < 0) return cannotWrite(path);

  Descriptor file(fd);
  struct stat old {};
  if (::stat(target.c_str(), &old) == 0) (void)::fchmod(fd, old.st_mode & 07777);
  bool good = writeAll(fd, bytes) && ::fsync(fd) == 0;
  good = file.closeNow() && good;
  if (!good || ::rename(beside.c_str(), target.c_str()) != 0) {
    Result<void> error = cannotWrite(path);
    ::unlink(beside.c_str());
    return error;
  }
  return {};
}

namespace io {

Result<std::string> readFile(const fs::path& path) {
  const auto unreadable = [&](const std::string& why) {
    return fail(ErrorCode::UnreadableInput, fmt::format("cannot read {}: {}", path.string(), why));
  };
  // Not blocking: opening a pipe must not wait for a writer.
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.get() < 0) return unreadable(reason());
  struct stat info {};
  if (::fstat(file.get(), &info) != 0) return unreadable(reason());
  if (!S_ISREG(info.st_mode)) return unreadable("it is not a regular file");
  if (info.st_size == 0) return unreadable("the file is empty");

  std::string bytes;
  try {
    bytes.resize(static_cast<std::size_t>(info.st_size));
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::ResourceLimit,
                fmt::format("cannot read {}: no memory for its {} bytes", path.string(),
                            static_cast<long long>(info.st_size)));
  }
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::read(file.get(), bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return unreadable(reason());
    if (n == 0) break;  // became shorter while being read
    done += static_cast<std::size_t>(n);
  }
  bytes.resize(done);
  return bytes;
}

std::string lowerExtension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

}  // namespace io
}  // namespace phront
