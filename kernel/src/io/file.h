// Whole files in and out of memory.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "phront/status.h"

namespace phront::io {

/// All bytes of a regular file. Fails with UnreadableInput (not there, a folder, empty, read
/// error).
[[nodiscard]] Result<std::string> readFile(const std::filesystem::path& path);

/// Extension in lower case, with its dot.
[[nodiscard]] std::string lowerExtension(const std::filesystem::path& path);

}  // namespace phront::io
