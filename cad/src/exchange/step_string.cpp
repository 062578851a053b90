#include "exchange/step_string.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>

namespace phront::cad {
namespace {

// The code point at `i`, which moves past it; '?' for a malformed one.
std::uint32_t nextCodePoint(std::string_view text, std::size_t& i) {
  const auto lead = static_cast<unsigned char>(text[i++]);
  if (lead < 0x80) return lead;
  const int more = lead >= 0xF0 ? 3 : lead >= 0xE0 ? 2 : lead >= 0xC0 ? 1 : 0;
  if (more == 0) return '?';
  std::uint32_t point = lead & (0x3FU >> more);
  for (int k = 0; k < more; ++k) {
    if (i == text.size() || (static_cast<unsigned char>(text[i]) & 0xC0) != 0x80) return '?';
    point = (point << 6) | (static_cast<unsigned char>(text[i++]) & 0x3FU);
  }
  return point;
}

void appendUtf8(std::uint32_t point, std::string& out) {
  if (point < 0x80) {
    out += static_cast<char>(point);
  } else if (point < 0x800) {
    out += static_cast<char>(0xC0 | (point >> 6));
    out += static_cast<char>(0x80 | (point & 0x3F));
  } else if (point < 0x10000) {
    out += static_cast<char>(0xE0 | (point >> 12));
    out += static_cast<char>(0x80 | ((point >> 6) & 0x3F));
    out += static_cast<char>(0x80 | (point & 0x3F));
  } else {
    out += static_cast<char>(0xF0 | ((point >> 18) & 0x07));
    out += static_cast<char>(0x80 | ((point >> 12) & 0x3F));
    out += static_cast<char>(0x80 | ((point >> 6) & 0x3F));
    out += static_cast<char>(0x80 | (point & 0x3F));
  }
}

bool hexAt(std::string_view text, std::size_t i, std::size_t digits, std::uint32_t& value) {
  if (i + digits > text.size()) return false;
  const char* end = text.data() + i + digits;
  return std::from_chars(text.data() + i, end, value, 16).ptr == end;
}

// Decodes "\X2\....\X0\" (4 digits each) or "\X4\" (8) at `i`; false when malformed.
bool decodeRun(std::string_view text, std::size_t& i, std::size_t digits, std::string& out) {
  std::size_t at = i + 4;
  std::string run;
  std::uint32_t value = 0;
  while (hexAt(text, at, digits, value)) {
    at += digits;
    std::uint32_t low = 0;
    const bool surrogate = digits == 4 && value >= 0xD800 && value < 0xDC00;
    if (surrogate && hexAt(text, at, digits, low)) {
      value = 0x10000 + ((value - 0xD800) << 10) + (low - 0xDC00);
      at += digits;
    }
    appendUtf8(value, run);
  }
  if (text.substr(at, 4) != "\\X0\\") return false;
  out += run;
  i = at + 4;
  return true;
}

}  // namespace

std::string stepString(std::string_view utf8) {
  std::string out;
  for (std::size_t i = 0; i < utf8.size();) {
    const std::uint32_t point = nextCodePoint(utf8, i);
    if (point == '\\') {
      out += "\\\\";
    } else if (point < 0x20 || point == 0x7F) {
      out += ' ';
    } else if (point < 0x7F) {
      out += static_cast<char>(point);
    } else if (point < 0x10000) {
      out += fmt::format("\\X2\\{:04X}\\X0\\", point);
    } else {
      out += fmt::format("\\X4\\{:08X}\\X0\\", point);
    }
  }
  return out;
}

std::string textOfStepString(std::string_view encoded) {
  std::string out;
  for (std::size_t i = 0; i < encoded.size();) {
    const std::string_view rest = encoded.substr(i);
    std::uint32_t value = 0;
    if (rest.starts_with("\\\\")) {
      out += '\\';
      i += 2;
    } else if (rest.starts_with("\\X2\\") && decodeRun(encoded, i, 4, out)) {
      continue;
    } else if (rest.starts_with("\\X4\\") && decodeRun(encoded, i, 8, out)) {
      continue;
    } else if (rest.starts_with("\\X\\") && hexAt(encoded, i + 3, 2, value)) {
      appendUtf8(value, out);
      i += 5;
    } else if (rest.starts_with("\\S\\") && rest.size() > 3) {
      appendUtf8(static_cast<unsigned char>(rest[3]) + 0x80U, out);
      i += 4;
    } else {
      out += encoded[i++];
    }
  }
  return out;
}

}  // namespace phront::cad
