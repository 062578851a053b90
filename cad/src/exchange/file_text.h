// A CAD file as bytes: is it there, what is it, is it whole?
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "phront/cad/exchange.h"
#include "phront/status.h"

namespace phront::cad {

struct FileText {
  std::string bytes;  ///< without a byte-order mark
  ShapeFormat format = ShapeFormat::Step;
  bool binaryBrep = false;
  std::vector<std::string> warnings;
};

/// Reads the file and tells its format from its content. Fails with UnreadableInput when it is not
/// there, a folder, forbidden, empty, larger than `maxBytes`, or of no format known.
[[nodiscard]] Result<FileText> loadFile(const std::filesystem::path& path, std::size_t maxBytes);

/// Why an IGES text cannot be read (columns, terminate line, numbers that are none), or nothing.
[[nodiscard]] std::optional<std::string> igesDefect(std::string_view text);

/// Why a BREP text cannot be read (numbers that are none), or nothing.
[[nodiscard]] std::optional<std::string> brepDefect(std::string_view text);

}  // namespace phront::cad
