// The first bytes tell the format; the extension only when they do not. IGES is checked by its
// fixed columns (ANSI US PRO/IPO-100: section letter in column 73, counts in the terminate line),
// since OpenCASCADE reads a shifted or shortened IGES file without complaint.
#include "exchange/file_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>

namespace phront::cad {
namespace {

namespace fs = std::filesystem;

// How far into a file its signature may start.
constexpr std::size_t kSignatureReach = 256;
constexpr std::size_t kIgesLetterColumn = 72;

std::string_view skipBlank(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first == std::string_view::npos ? std::string_view() : text.substr(first);
}

std::string_view firstLine(std::string_view text) {
  const std::string_view line = text.substr(0, text.find('\n'));
  return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
}

bool isIges(std::string_view text) {
  const std::string_view line = firstLine(text);
  return line.size() > kIgesLetterColumn && line[kIgesLetterColumn] == 'S' &&
         line.substr(kIgesLetterColumn + 1).find('1') != std::string_view::npos;
}

struct Signature {
  std::optional<ShapeFormat> format;
  bool binaryBrep = false;
};

Signature signatureOf(std::string_view text) {
  const std::string_view head = skipBlank(text.substr(0, kSignatureReach));
  if (head.starts_with("ISO-10303-21")) return {ShapeFormat::Step, false};
  if (head.starts_with("DBRep_DrawableShape") || head.starts_with("CASCADE Topology")) {
    return {ShapeFormat::Brep, false};
  }
  if (head.starts_with("Open CASCADE Topology")) return {ShapeFormat::Brep, true};
  if (isIges(text)) return {ShapeFormat::Iges, false};
  return {};
}

std::string formatName(ShapeFormat format) {
  switch (format) {
    case ShapeFormat::Step:
      return "STEP";
    case ShapeFormat::Iges:
      return "IGES";
    case ShapeFormat::Brep:
      return "BREP";
  }
  return {};
}

// What a file of no known signature is, or lacks, as the end of a sentence.
std::string strangerSentence(std::string_view bytes, const Result<ShapeFormat>& byName) {
  if (bytes.starts_with("PK\x03\x04") || bytes.starts_with("\x1f\x8b")) {
    return "it is a compressed archive: unpack it first";
  }
  if (bytes.starts_with("solid ")) return "it looks like an STL mesh, which has no exact surfaces";
  if (!byName) return "its content is neither STEP, IGES nor BREP";
  switch (*byName) {
    case ShapeFormat::Step:
      return "it is not a STEP file (it does not begin with ISO-10303-21)";
    case ShapeFormat::Iges:
      return "it is not an IGES file of fixed 80-column lines (no section letter S in column 73 of "
             "the first line)";
    case ShapeFormat::Brep:
      return "it is not a BREP file (no 'CASCADE Topology' at its beginning)";
  }
  return {};
}

Result<std::string> readAll(const fs::path& path, std::size_t maxBytes) {
  const std::string what = "reading " + path.filename().string() + ": ";
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) {
    return fail(ErrorCode::UnreadableInput, what + "there is no such file", path.string());
  }
  if (fs::is_directory(status)) {
    return fail(ErrorCode::UnreadableInput, what + "it is a folder, not a file", path.string());
  }
  if (!fs::is_regular_file(status)) {
    return fail(ErrorCode::UnreadableInput, what + "it is not a regular file", path.string());
  }
  const std::uintmax_t size = fs::file_size(path, error);
  std::ifstream stream(path, std::ios::binary);
  if (!stream || error) {
    return fail(ErrorCode::UnreadableInput, what + std::strerror(errno ? errno : EIO),
                path.string());
  }
  if (size == 0) {
    return fail(ErrorCode::UnreadableInput, what + "the file is empty", path.string());
  }
  if (size > maxBytes) {
    return fail(
        ErrorCode::ResourceLimit,
        fmt::format("{}its {} MiB need more memory than the limit allows", what, size >> 20),
        path.string());
  }
  std::string bytes(size, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(stream.gcount()) != size) {
    return fail(ErrorCode::UnreadableInput, what + "the file cannot be read to its end",
                path.string());
  }
  return bytes;
}

bool equalNoCase(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) == y;
  });
}

bool isNotANumber(std::string_view token) {
  if (token.starts_with('-') || token.starts_with('+')) token.remove_prefix(1);
  return equalNoCase(token, "nan") || equalNoCase(token, "inf") || equalNoCase(token, "infinity") ||
         equalNoCase(token, "nan(ind)") || equalNoCase(token, "1.#qnan") ||
         equalNoCase(token, "1.#inf") || equalNoCase(token, "1.#ind");
}

std::optional<std::string> notANumberIn(std::string_view line, std::string_view separators) {
  while (!line.empty()) {
    const std::size_t end = std::min(line.find_first_of(separators), line.size());
    const std::string_view token = line.substr(0, end);
    if (isNotANumber(token)) return std::string(token);
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return std::nullopt;
}

std::size_t countInTerminate(std::string_view line, std::size_t section) {
  std::size_t count = 0;
  for (const char c : line.substr(8 * section + 1, 7)) {
    if (c >= '0' && c <= '9') count = 10 * count + static_cast<std::size_t>(c - '0');
  }
  return count;
}

}  // namespace

Result<FileText> loadFile(const fs::path& path, std::size_t maxBytes) {
  auto bytes = readAll(path, maxBytes);
  if (!bytes) return tl::unexpected<Error>(bytes.error());
  FileText file;
  file.bytes = std::move(*bytes);
  if (file.bytes.starts_with("\xEF\xBB\xBF")) file.bytes.erase(0, 3);
  const Signature signature = signatureOf(file.bytes);
  const Result<ShapeFormat> byName = shapeFormatOf(path);
  if (!signature.format) {
    return fail(ErrorCode::UnreadableInput,
                fmt::format("reading {}: {}", path.filename().string(),
                            strangerSentence(file.bytes, byName)),
                path.string());
  }
  file.format = *signature.format;
  file.binaryBrep = signature.binaryBrep;
  if (byName && *byName != file.format) {
    file.warnings.push_back(fmt::format("{} is named as {} but holds {}: read as {}",
                                        path.filename().string(), formatName(*byName),
                                        formatName(file.format), formatName(file.format)));
  }
  return file;
}

std::optional<std::string> igesDefect(std::string_view text) {
  static constexpr std::string_view kSections = "SGDPT";
  std::array<std::size_t, 5> lines{};
  std::string_view terminate;
  std::size_t number = 0;
  while (!text.empty() && terminate.empty()) {
    const std::string_view line = firstLine(text);
    text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
    ++number;
    if (skipBlank(line).empty()) continue;
    const std::size_t section = line.size() > kIgesLetterColumn
                                    ? kSections.find(line[kIgesLetterColumn])
                                    : std::string_view::npos;
    if (section == std::string_view::npos) {
      return fmt::format("line {} has no section letter (S, G, D, P, T) in column 73", number);
    }
    ++lines[section];
    if (section == 4) terminate = line;
    if (section != 3) continue;
    // Columns 65 to 72 point back to the directory.
    if (const auto token = notANumberIn(line.substr(0, 64), ",; ")) {
      return fmt::format("line {} has '{}' for a number", number, *token);
    }
  }
  if (terminate.empty()) return "it is cut short (its terminate line, T, is missing)";
  for (std::size_t s = 0; s < 4; ++s) {
    const std::size_t promised = countInTerminate(terminate, s);
    if (promised != lines[s]) {
      return fmt::format("its section {} has {} lines, its last line promises {}", kSections[s],
                         lines[s], promised);
    }
  }
  return std::nullopt;
}

std::optional<std::string> brepDefect(std::string_view text) {
  const auto token = notANumberIn(text, " \n\r\t");
  if (token) return fmt::format("it has '{}' for a number", *token);
  if (text.find("TShapes ") == std::string_view::npos) {
    return "it is cut short (it has no TShapes section)";
  }
  return std::nullopt;
}

}  // namespace phront::cad
