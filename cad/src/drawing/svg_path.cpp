#include "drawing/svg_path.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

namespace phront::cad {

void NumberReader::skip() {
  while (at_ < text_.size() &&
         (std::isspace(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == ',')) {
    ++at_;
  }
}

std::optional<double> NumberReader::number() {
  skip();
  std::size_t from = at_;
  if (from < text_.size() && text_[from] == '+') ++from;  // from_chars takes no plus
  double value = 0;
  const auto [end, error] =
      std::from_chars(text_.data() + from, text_.data() + text_.size(), value);
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  at_ = static_cast<std::size_t>(end - text_.data());
  return value;
}

std::optional<bool> NumberReader::flag() {
  skip();
  if (at_ >= text_.size() || (text_[at_] != '0' && text_[at_] != '1')) return std::nullopt;
  return text_[at_++] == '1';
}

std::optional<char> NumberReader::letter() {
  skip();
  if (at_ >= text_.size() || std::isalpha(static_cast<unsigned char>(text_[at_])) == 0) {
    return std::nullopt;
  }
  return text_[at_++];
}

bool NumberReader::atEnd() {
  skip();
  return at_ >= text_.size();
}

namespace {

constexpr int kMostHalvings = 16;

class PathReader {
 public:
  PathReader(std::string_view d, const Eigen::Affine2d& place, double tolerance)
      : read_(d), place_(place), tolerance_(tolerance) {}

  std::vector<Chain> run() {
    char command = 0;
    while (!read_.atEnd()) {
      if (const auto letter = read_.letter()) {
        command = *letter;
      } else if (command == 'M') {
        command = 'L';  // more pairs after a move are lines
      } else if (command == 'm') {
        command = 'l';
      } else if (command == 0 || command == 'z' || command == 'Z') {
        break;
      }
      if (!step(command)) break;
      last_ = command;
    }
    finish(false);
    return std::move(chains_);
  }

 private:
  bool step(char command) {
    const bool relative = std::islower(static_cast<unsigned char>(command)) != 0;
    const Vec2 origin = relative ? at_ : Vec2(Vec2::Zero());
    switch (std::toupper(static_cast<unsigned char>(command))) {
      case 'M': {
        const auto p = point(origin);
        if (!p) return false;
        finish(false);
        at_ = start_ = *p;
        return true;
      }
      case 'L': {
        const auto p = point(origin);
        if (p) lineTo(*p);
        return p.has_value();
      }
      case 'H': {
        const auto x = read_.number();
        if (x) lineTo({origin.x() + *x, at_.y()});
        return x.has_value();
      }
      case 'V': {
        const auto y = read_.number();
        if (y) lineTo({at_.x(), origin.y() + *y});
        return y.has_value();
      }
      case 'C':
      case 'S': {
        const bool smooth = std::toupper(static_cast<unsigned char>(command)) == 'S';
        const std::optional<Vec2> a = smooth ? reflected("CcSs") : point(origin);
        const auto b = a ? point(origin) : std::nullopt;
        const auto c = b ? point(origin) : std::nullopt;
        if (c) cubicTo(*a, *b, *c);
        return c.has_value();
      }
      case 'Q':
      case 'T': {
        const bool smooth = std::toupper(static_cast<unsigned char>(command)) == 'T';
        const std::optional<Vec2> a = smooth ? reflected("QqTt") : point(origin);
        const auto b = a ? point(origin) : std::nullopt;
        if (!b) return false;
        cubicTo(at_ + 2.0 / 3 * (*a - at_), *b + 2.0 / 3 * (*a - *b), *b);
        control_ = *a;
        return true;
      }
      case 'A':
        return arc(origin);
      case 'Z':
        finish(true);
        at_ = start_;
        return true;
      default:
        return false;
    }
  }

  std::optional<Vec2> point(const Vec2& origin) {
    const auto x = read_.number();
    const auto y = x ? read_.number() : std::nullopt;
    if (!y) return std::nullopt;
    return Vec2(origin.x() + *x, origin.y() + *y);
  }

  /// The mirrored control point of the curve before, if it was of this kind.
  [[nodiscard]] Vec2 reflected(std::string_view kind) const {
    return kind.find(last_) == std::string_view::npos ? at_ : Vec2(2 * at_ - control_);
  }

  void begin() {
    if (chain_.points.empty()) chain_.points.push_back(place_ * at_);
  }

  void lineTo(const Vec2& p) {
    begin();
    chain_.points.push_back(place_ * p);
    at_ = p;
  }

  void cubicTo(const Vec2& a, const Vec2& b, const Vec2& c) {
    begin();
    flatten({place_ * at_, place_ * a, place_ * b, place_ * c}, 0);
    control_ = b;
    at_ = c;
  }

  void flatten(const std::array<Vec2, 4>& p, int depth) {
    // A cubic lies within 3/4 of the distance of its inner poles from those of its chord.
    const Vec2 chord = (p[3] - p[0]) / 3;
    const double off = std::max((p[1] - p[0] - chord).norm(), (p[2] - p[0] - 2 * chord).norm());
    if (0.75 * off <= tolerance_ || depth == kMostHalvings) {
      chain_.points.push_back(p[3]);
      return;
    }
    const Vec2 ab = 0.5 * (p[0] + p[1]);
    const Vec2 bc = 0.5 * (p[1] + p[2]);
    const Vec2 cd = 0.5 * (p[2] + p[3]);
    const Vec2 abc = 0.5 * (ab + bc);
    const Vec2 bcd = 0.5 * (bc + cd);
    const Vec2 middle = 0.5 * (abc + bcd);
    flatten({p[0], ab, abc, middle}, depth + 1);
    flatten({middle, bcd, cd, p[3]}, depth + 1);
  }

  /// Ends to centre as in SVG 1.1, F.6.5.
  bool arc(const Vec2& origin) {
    const auto rx = read_.number();
    const auto ry = rx ? read_.number() : std::nullopt;
    const auto degrees = ry ? read_.number() : std::nullopt;
    const auto large = degrees ? read_.flag() : std::nullopt;
    const auto sweep = large ? read_.flag() : std::nullopt;
    const auto end = sweep ? point(origin) : std::nullopt;
    if (!end) return false;
    double a = std::abs(*rx);
    double b = std::abs(*ry);
    if (a == 0 || b == 0 || *end == at_) {
      if (*end != at_) lineTo(*end);
      return true;
    }
    const Eigen::Rotation2Dd turn(*degrees * std::numbers::pi / 180);
    const Vec2 half = turn.inverse() * (0.5 * (at_ - *end));
    const double size = half.cwiseQuotient(Vec2(a, b)).squaredNorm();
    if (size > 1) {  // too small to reach: as large as needed
      a *= std::sqrt(size);
      b *= std::sqrt(size);
    }
    const double down = a * a * half.y() * half.y() + b * b * half.x() * half.x();
    double factor = std::sqrt(std::max(0.0, (a * a * b * b - down) / down));
    if (*large == *sweep) factor = -factor;
    const Vec2 centre(factor * a * half.y() / b, -factor * b * half.x() / a);
    const auto angle = [&](const Vec2& p) {
      return std::atan2((p.y() - centre.y()) / b, (p.x() - centre.x()) / a);
    };
    const double from = angle(half);
    double to = angle(-half);
    if (*sweep && to < from) to += 2 * std::numbers::pi;
    if (!*sweep && to > from) to -= 2 * std::numbers::pi;
    begin();
    const Vec2 middle = turn * centre + 0.5 * (at_ + *end);
    const std::vector<Vec2> points =
        ellipseArc(place_ * middle, place_.linear() * (turn * Vec2(a, 0)),
                   place_.linear() * (turn * Vec2(0, b)), from, to, tolerance_);
    chain_.points.insert(chain_.points.end(), points.begin() + 1, points.end() - 1);
    chain_.points.push_back(place_ * *end);
    at_ = *end;
    return true;
  }

  void finish(bool closed) {
    chain_.closed = closed;
    if (chain_.points.size() > 1) chains_.push_back(std::move(chain_));
    chain_ = Chain();
  }

  NumberReader read_;
  const Eigen::Affine2d& place_;
  double tolerance_;
  std::vector<Chain> chains_;
  Chain chain_;
  Vec2 at_ = Vec2::Zero();
  Vec2 start_ = Vec2::Zero();
  Vec2 control_ = Vec2::Zero();
  char last_ = 0;
};

}  // namespace

std::vector<Chain> chainsOfPath(std::string_view d, const Eigen::Affine2d& place,
                                double tolerance) {
  return PathReader(d, place, tolerance).run();
}

}  // namespace phront::cad
