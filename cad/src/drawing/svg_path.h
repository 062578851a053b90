// The path language of SVG.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string_view>
#include <vector>

#include "drawing/chain.h"

namespace phront::cad {

/// Reads numbers separated by blanks and commas.
class NumberReader {
 public:
  explicit NumberReader(std::string_view text) : text_(text) {}
  [[nodiscard]] std::optional<double> number();
  /// 0 or 1, which may stand without a separator.
  [[nodiscard]] std::optional<bool> flag();
  /// The next letter, if the next thing is one.
  [[nodiscard]] std::optional<char> letter();
  [[nodiscard]] bool atEnd();
  /// What comes after the number just read, up to a separator: its unit.
  [[nodiscard]] std::string_view rest() const { return text_.substr(at_); }

 private:
  void skip();
  std::string_view text_;
  std::size_t at_ = 0;
};

/// The chains of the path data `d` (SVG 1.1, 8.3), transformed; curves flattened so that chords are
/// off by at most `tolerance` after it. Empty when the data is no path; what comes before a defect
/// is drawn, as the standard asks.
[[nodiscard]] std::vector<Chain> chainsOfPath(std::string_view d, const Eigen::Affine2d& place,
                                              double tolerance);

}  // namespace phront::cad
