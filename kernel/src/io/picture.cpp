// Pictures are drawn by a module that is loaded when the first picture is asked for: linked in, VTK
// would cost every start of a program some 30 ms (measured: 0.104 s against 0.145 s for the command
// line's libraries), and a program without pictures would need VTK to be installed.
#include "phront/picture.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <new>

#include "io/file.h"
#include "io/picture_scene.h"
#include "phront/mesh_io.h"

namespace phront {
namespace {

namespace fs = std::filesystem;

constexpr int kSmallest = 64;     // pixels; below, nothing can be seen
constexpr int kLargest = 16'384;  // pixels; the limit of software GL
constexpr std::size_t kMostItems = 16;

Result<void> validate(std::span<const PictureItem> items, const fs::path& path,
                      const PictureOptions& options) {
  const auto invalid = [](std::string message) {
    return fail(ErrorCode::InvalidArgument, std::move(message));
  };
  if (io::lowerExtension(path) != ".png") {
    return invalid(fmt::format("{}: pictures are written as .png", path.string()));
  }
  if (items.empty() || items.size() > kMostItems) {
    return invalid(fmt::format("a picture shows 1 to {} items, not {}", kMostItems, items.size()));
  }
  for (const int size : {options.width, options.height}) {
    if (size < kSmallest || size > kLargest) {
      return invalid(fmt::format("picture of {} x {} pixels; each must be {} to {}", options.width,
                                 options.height, kSmallest, kLargest));
    }
  }
  if (!options.view.allFinite() || !(options.view.norm() > 0)) {
    return invalid("the view direction of a picture must be finite and not zero");
  }
  for (const PictureItem& item : items) {
    const MeshDiagnostics found = diagnose(item.mesh);
    if (found.badIndices > 0 || found.nonFinitePoints > 0) {
      return invalid(fmt::format("\"{}\" cannot be drawn: {} bad indices, {} points not finite",
                                 item.caption, found.badIndices, found.nonFinitePoints));
    }
  }
  return {};
}

/// Beside the program (build folder), where it was installed (moved or not), where the loader
/// looks.
std::array<fs::path, 4> moduleCandidates() {
  const fs::path name = PHRONT_PICTURE_MODULE;
  std::error_code ignored;
  const fs::path bin = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  return {bin / name, bin / PHRONT_MODULE_FROM_BIN / name, fs::path(PHRONT_MODULE_FOLDER) / name,
          name};
}

Result<io::DrawScene> loadModule() {
  std::string reason = "it is not there";
  for (const fs::path& candidate : moduleCandidates()) {
    void* module = ::dlopen(candidate.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (module == nullptr) {
      std::error_code ignored;
      if (fs::exists(candidate, ignored)) reason = ::dlerror();
      continue;
    }
    if (void* symbol = ::dlsym(module, io::kDrawSymbol)) {
      return reinterpret_cast<io::DrawScene>(symbol);  // never unloaded: VTK keeps global tables
    }
    reason = fmt::format("{} is of another version", candidate.string());
    ::dlclose(module);
  }
  return fail(
      ErrorCode::NotSupported,
      fmt::format("no picture: phront's drawing module {} cannot be used ({}); build phront "
                  "with VTK and EGL to have it",
                  PHRONT_PICTURE_MODULE, reason));
}

}  // namespace

Result<void> writePicture(std::span<const PictureItem> items, const fs::path& path,
                          const PictureOptions& options) try {
  if (auto good = validate(items, path, options); !good) return good;
  static const Result<io::DrawScene> draw = loadModule();
  if (!draw) return tl::unexpected(draw.error());
  Result<std::string> png;
  (*draw)(io::makeScene(items, options), png);
  if (!png) return tl::unexpected(png.error());
  return writeFileAtomically(path, *png);
} catch (const std::bad_alloc&) {
  return fail(ErrorCode::ResourceLimit,
              fmt::format("cannot draw {}: out of memory", path.string()));
}

}  // namespace phront
