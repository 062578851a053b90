// Words and numbers out of text, without locale and without copies.
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace phront::io {

inline bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }
inline bool isSpace(char c) { return isBlank(c) || c == '\n'; }

/// Walks over text. Line ends may be LF or CRLF.
class TextCursor {
 public:
  explicit TextCursor(std::string_view text) : text_(text) {}

  /// Next word, over line ends; empty at the end.
  std::string_view word() {
    while (at_ < text_.size() && isSpace(text_[at_])) ++at_;
    const std::size_t begin = at_;
    while (at_ < text_.size() && !isSpace(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
  }

  /// Rest of the present line without its line end; the cursor then is on the next line.
  std::string_view line() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && text_[at_] != '\n') ++at_;
    std::string_view found = text_.substr(begin, at_ - begin);
    if (at_ < text_.size()) ++at_;
    if (!found.empty() && found.back() == '\r') found.remove_suffix(1);
    return found;
  }

  [[nodiscard]] bool atEnd() const { return at_ >= text_.size(); }
  [[nodiscard]] std::size_t position() const { return at_; }
  [[nodiscard]] std::size_t remaining() const { return text_.size() - at_; }

  /// Number of the present line, from 1. Counts anew: for messages only.
  [[nodiscard]] std::size_t lineNumber() const {
    std::size_t n = 1;
    for (std::size_t i = 0; i < at_; ++i) n += text_[i] == '\n' ? 1 : 0;
    return n;
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

/// The whole word as a whole number, else nothing.
template <class Number>
std::optional<Number> parseInteger(std::string_view word) {
  Number value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// A finite coordinate. What is too small for a double counts as zero.
inline std::optional<double> parseCoordinate(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);
  double value = 0;
  const char* const last = word.data() + word.size();
  const auto [end, error] = std::from_chars(word.data(), last, value);
  if (end != last) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    // Overflow and underflow are reported alike; only the latter has a negative exponent.
    const std::size_t e = word.find_first_of("eE");
    const bool tiny = e != std::string_view::npos && e + 1 < word.size() && word[e + 1] == '-';
    return tiny ? std::optional<double>(0.0) : std::nullopt;
  }
  if (error != std::errc{} || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace phront::io
