// A tokenizer after ISO 10303-21 (clear text encoding): strings with doubled quotes, comments,
// enumerations between dots, references #n, numbers, keywords. It looks for nothing but what is
// known to send OpenCASCADE astray, and never fails: what it does not understand it skips.
#include "exchange/step_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace phront::cad {
namespace {

bool isWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }
bool isDigit(char c) { return c >= '0' && c <= '9'; }

// End of the string that starts at `i` (a quote), past its closing quote; npos if unterminated.
std::size_t skipString(std::string_view text, std::size_t i) {
  const std::size_t end = text.find('\'', i + 1);
  return end == std::string_view::npos ? end : end + 1;  // '' is two strings: no harm
}

std::size_t skipComment(std::string_view text, std::size_t i) {
  const std::size_t end = text.find("*/", i + 2);
  return end == std::string_view::npos ? end : end + 2;
}

// Past the ';' that ends the statement at `i`; npos if there is none.
std::size_t statementEnd(std::string_view text, std::size_t i) {
  while (i < text.size()) {
    const char c = text[i];
    if (c == '\'') {
      i = skipString(text, i);
    } else if (c == '/' && i + 1 < text.size() && text[i + 1] == '*') {
      i = skipComment(text, i);
    } else if (c == ';') {
      return i + 1;
    } else {
      ++i;
    }
  }
  return std::string_view::npos;
}

std::size_t skipBlank(std::string_view text, std::size_t i) {
  while (i < text.size()) {
    if (std::isspace(static_cast<unsigned char>(text[i]))) {
      ++i;
    } else if (text[i] == '/' && i + 1 < text.size() && text[i + 1] == '*') {
      i = skipComment(text, i);
    } else {
      break;
    }
  }
  return std::min(i, text.size());
}

std::string_view wordAt(std::string_view text, std::size_t i) {
  std::size_t end = i;
  while (end < text.size() && isWord(text[end])) ++end;
  return text.substr(i, end - i);
}

std::int64_t integerAt(std::string_view digits) {
  std::int64_t value = -1;
  std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return value;
}

bool isNotANumber(std::string_view word) {
  std::string lower(word);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower == "nan" || lower == "inf" || lower == "infinity" || lower == "ind" ||
         lower == "qnan" || lower == "snan";
}

// Which numbers of a B-spline must be at least one: the degrees (first integers outside any list of
// its own keyword) and the multiplicities (first lists of numbers).
class SplineNumbers {
 public:
  void keyword(std::string_view word) {
    const bool curve = word.substr(0, 14) == "B_SPLINE_CURVE";
    const bool surface = word.substr(0, 16) == "B_SPLINE_SURFACE";
    if (!curve && !surface) {
      if (word.substr(0, 8) == "RATIONAL") lists_ = 0;
      return;
    }
    const bool withKnots = word.find("_WITH_KNOTS") != std::string_view::npos;
    degrees_ = !withKnots || !complex_ ? (surface ? 2 : 1) : 0;
    lists_ = withKnots ? (surface ? 2 : 1) : 0;
  }
  void complex(bool is) { complex_ = is; }
  void closeList() {
    if (inList_) --lists_;
    inList_ = false;
  }
  // True when this number may not be what it is.
  bool number(bool isInteger, double value, int depthInKeyword) {
    if (!isInteger) return false;
    if (depthInKeyword == 1 && degrees_ > 0) {
      --degrees_;
      return value < 1;
    }
    if (depthInKeyword == 2 && lists_ > 0) {
      inList_ = true;
      return value < 1;
    }
    return false;
  }

 private:
  bool complex_ = false;
  bool inList_ = false;
  int degrees_ = 0;
  int lists_ = 0;
};

}  // namespace

bool hasKeyword(std::string_view text, std::string_view keyword) {
  for (std::size_t i = text.find(keyword); i != std::string_view::npos;
       i = text.find(keyword, i + 1)) {
    const std::size_t end = i + keyword.size();
    if ((i == 0 || !isWord(text[i - 1])) && (end == text.size() || !isWord(text[end]))) return true;
  }
  return false;
}

StepText::StepText(std::string_view text) {
  parse(text);
  indexOf_.reserve(entities_.size());
  for (std::size_t i = 0; i < entities_.size(); ++i) indexOf_.emplace(entities_[i].id, i);
}

void StepText::parse(std::string_view text) {
  std::size_t i = skipBlank(text, 0);
  while (i < text.size()) {
    const std::size_t end = statementEnd(text, i);
    if (end == std::string_view::npos) {
      // The end line may lack its semicolon.
      endLine = endLine || text.substr(i).substr(0, 16) == "END-ISO-10303-21";
      return;
    }
    const std::string_view statement = text.substr(i, end - i - 1);
    const std::string_view word = wordAt(text, i);
    if (statement.starts_with("END-ISO-10303-21")) {
      endLine = true;
      return;
    }
    if (word == "DATA") {
      hasData = true;
      dataEnds = false;
    } else if (word == "ENDSEC") {
      dataEnds = hasData;
    } else if (hasData && !dataEnds && statement.starts_with('#')) {
      parseEntity(statement);
    }
    i = skipBlank(text, end);
  }
}

void StepText::parseEntity(std::string_view statement) {
  const std::size_t equal = statement.find('=');
  if (equal == std::string_view::npos) return;
  StepEntity entity;
  entity.id = integerAt(statement.substr(1));
  entity.text = statement.substr(skipBlank(statement, equal + 1));
  entity.firstRef = static_cast<std::uint32_t>(refs_.size());
  const std::string_view text = entity.text;
  SplineNumbers spline;
  spline.complex(text.starts_with('('));
  const int keywordDepth = text.starts_with('(') ? 1 : 0;
  int depth = 0;
  std::size_t i = 0;
  while (i < text.size()) {
    const char c = text[i];
    if (c == '\'') {
      i = skipString(text, i);
    } else if (c == '"') {
      const std::size_t close = text.find('"', i + 1);
      i = close == std::string_view::npos ? close : close + 1;
    } else if (c == '/' && i + 1 < text.size() && text[i + 1] == '*') {
      i = skipComment(text, i);
    } else if (c == '(' || c == ')') {
      depth += c == '(' ? 1 : -1;
      if (c == ')') spline.closeList();
      ++i;
    } else if (c == '#') {
      const std::string_view digits = wordAt(text, i + 1);
      refs_.push_back(integerAt(digits));
      i += 1 + digits.size();
    } else if (c == '.' && i + 1 < text.size() &&
               std::isalpha(static_cast<unsigned char>(text[i + 1]))) {
      const std::size_t close = text.find('.', i + 1);  // an enumeration
      i = close == std::string_view::npos ? close : close + 1;
    } else if (isDigit(c) || c == '-' || c == '+' || c == '.') {
      const std::size_t start = i;
      bool isInteger = true;
      for (; i < text.size() && (isWord(text[i]) || text[i] == '-' || text[i] == '+' ||
                                 text[i] == '.' || text[i] == '#');
           ++i) {
        isInteger = isInteger && (isDigit(text[i]) || text[i] == '-' || text[i] == '+');
      }
      const std::string token(text.substr(start, i - start));
      char* parsed = nullptr;
      const double value = std::strtod(token.c_str(), &parsed);
      if (parsed != token.c_str() + token.size() || !std::isfinite(value)) {
        if (defect.empty())
          defect = fmt::format("entity #{} has '{}' for a number", entity.id, token);
      } else {
        ++entity.numberCount;
        entity.lastNumber = value;
        entity.largestNumber = std::max(entity.largestNumber, std::abs(value));
        entity.smallInteger |= spline.number(isInteger, value, depth - keywordDepth);
      }
    } else if (std::isalpha(static_cast<unsigned char>(c)) || c == '!') {
      const std::string_view word = wordAt(text, c == '!' ? i + 1 : i);
      if (entity.keyword.empty()) entity.keyword = word;
      i += word.size() + (c == '!' ? 1 : 0);
      const std::size_t next = skipBlank(text, i);
      if ((next == text.size() || text[next] != '(') && isNotANumber(word) && defect.empty()) {
        defect = fmt::format("entity #{} has '{}' for a number", entity.id, word);
      }
      spline.keyword(word);
    } else {
      ++i;
    }
  }
  entity.refCount = static_cast<std::uint32_t>(refs_.size()) - entity.firstRef;
  entities_.push_back(entity);
}

std::vector<std::size_t> StepText::targets(const StepEntity& entity) const {
  std::vector<std::size_t> found;
  for (std::uint32_t r = 0; r < entity.refCount; ++r) {
    const auto it = indexOf_.find(refs_[entity.firstRef + r]);
    if (it != indexOf_.end()) found.push_back(it->second);
  }
  return found;
}

std::int64_t StepText::missingTarget(const StepEntity& entity) const {
  for (std::uint32_t r = 0; r < entity.refCount; ++r) {
    if (!indexOf_.contains(refs_[entity.firstRef + r])) return refs_[entity.firstRef + r];
  }
  return -1;
}

bool StepText::refersToItself(const StepEntity& entity) const {
  const auto begin = refs_.begin() + entity.firstRef;
  return std::find(begin, begin + entity.refCount, entity.id) != begin + entity.refCount;
}

}  // namespace phront::cad
