// Offsets of drawings.
#pragma once

#include <filesystem>
#include <optional>

#include "cli.h"

namespace phront::cli {

/// True for .svg .dxf.
[[nodiscard]] bool isDrawingPath(const std::filesystem::path& path);

/// Drawing in, drawing out: the front phi = d of its curves. Returns the exit code.
int offsetDrawingFile(const std::filesystem::path& in, const std::filesystem::path& out,
                      double distance, std::optional<double> tolerance,
                      const CommonOptions& options);

}  // namespace phront::cli
