// One parser and one formatter per mesh format. Parsers take the bytes of a whole file and trust
// nothing in them: every count is checked against the bytes that are there before memory is asked
// for. They fail with UnreadableInput and a sentence without the file's name; the caller adds it.
#pragma once

#include <fmt/format.h>

#include <limits>
#include <string>
#include <string_view>

#include "phront/status.h"
#include "phront/tri_mesh.h"

namespace phront::io {

[[nodiscard]] Result<TriMesh> parseStl(std::string_view bytes);
[[nodiscard]] Result<TriMesh> parseObj(std::string_view bytes);
[[nodiscard]] Result<TriMesh> parsePly(std::string_view bytes);

/// Formatters expect a mesh with valid indices. formatStl fails with CannotWrite where a coordinate
/// is beyond single precision or there are too many triangles for the format.
[[nodiscard]] Result<std::string> formatStl(const TriMesh& mesh);
[[nodiscard]] std::string formatObj(const TriMesh& mesh);
[[nodiscard]] std::string formatPly(const TriMesh& mesh);
[[nodiscard]] std::string formatVtu(const TriMesh& mesh);

/// Largest number of points or triangles: what Index can count.
inline constexpr std::size_t kMaxCount = std::numeric_limits<Index>::max();

template <class... Args>
tl::unexpected<Error> unreadable(fmt::format_string<Args...> format, Args&&... args) {
  return fail(ErrorCode::UnreadableInput, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace phront::io
