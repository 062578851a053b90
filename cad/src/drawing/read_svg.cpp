// SVG by pugixml: the shapes of the document tree under their transforms. Not drawn, as in a
// viewer: what is hidden, only defined, clips or masks. Text, images and references are left out,
// with a warning.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <pugixml.hpp>
#include <set>
#include <string_view>

#include "drawing/readers.h"
#include "drawing/svg_path.h"

namespace phront::cad {
namespace {

constexpr double kPixel = 25.4 / 96;          // mm, CSS
constexpr double kAutomaticTolerance = 1e-5;  // of the larger side of the view
constexpr double kLeastTolerance = 1e-4;      // mm
constexpr int kDeepest = 200;                 // nested groups

/// mm, or nothing for percentages and the like.
std::optional<double> lengthIn(const char* text) {
  NumberReader reader{text};
  const auto value = reader.number();
  if (!value) return std::nullopt;
  const std::string_view unit = reader.rest();
  if (unit.empty() || unit.starts_with("px")) return *value * kPixel;
  if (unit.starts_with("mm")) return *value;
  if (unit.starts_with("cm")) return *value * 10;
  if (unit.starts_with("in")) return *value * 25.4;
  if (unit.starts_with("pt")) return *value * 25.4 / 72;
  if (unit.starts_with("pc")) return *value * 25.4 / 6;
  return std::nullopt;
}

std::optional<Eigen::Affine2d> transformOf(std::string_view text) {
  Eigen::Affine2d result = Eigen::Affine2d::Identity();
  while (true) {
    const std::size_t name = text.find_first_not_of(" \t\r\n,");
    if (name == std::string_view::npos) return result;
    const std::size_t open = text.find('(', name);
    const std::size_t close = text.find(')', name);
    if (open == std::string_view::npos || close == std::string_view::npos || close < open) {
      return std::nullopt;
    }
    std::string_view kind = text.substr(name, open - name);
    while (!kind.empty() && kind.back() == ' ') kind.remove_suffix(1);
    NumberReader reader{text.substr(open + 1, close - open - 1)};
    std::vector<double> v;
    while (const auto number = reader.number()) v.push_back(*number);
    text.remove_prefix(close + 1);
    const double degree = std::numbers::pi / 180;
    Eigen::Affine2d step = Eigen::Affine2d::Identity();
    if (kind == "matrix" && v.size() == 6) {
      step.matrix() << v[0], v[2], v[4], v[1], v[3], v[5], 0, 0, 1;
    } else if (kind == "translate" && !v.empty()) {
      step.translate(Vec2(v[0], v.size() > 1 ? v[1] : 0));
    } else if (kind == "scale" && !v.empty()) {
      step.scale(Vec2(v[0], v.size() > 1 ? v[1] : v[0]));
    } else if (kind == "rotate" && v.size() == 1) {
      step.rotate(v[0] * degree);
    } else if (kind == "rotate" && v.size() == 3) {
      step.translate(Vec2(v[1], v[2])).rotate(v[0] * degree).translate(Vec2(-v[1], -v[2]));
    } else if (kind == "skewX" && v.size() == 1) {
      step.linear()(0, 1) = std::tan(v[0] * degree);
    } else if (kind == "skewY" && v.size() == 1) {
      step.linear()(1, 0) = std::tan(v[0] * degree);
    } else {
      return std::nullopt;
    }
    result = result * step;
  }
}

class SvgReader {
 public:
  explicit SvgReader(double tolerance) { result_.tolerance = tolerance; }

  Result<RawDrawing> read(const pugi::xml_node& root) {
    Eigen::Affine2d place = Eigen::Affine2d::Identity();
    double unit = kPixel;
    double larger = 0;
    NumberReader box{root.attribute("viewBox").value()};
    std::vector<double> view;
    while (const auto number = box.number()) view.push_back(*number);
    const auto width = lengthIn(root.attribute("width").value());
    const auto height = lengthIn(root.attribute("height").value());
    if (view.size() == 4 && view[2] > 0 && view[3] > 0) {
      if (width) unit = *width / view[2];
      if (!width && height) unit = *height / view[3];
      if (width && height) unit = std::min(*width / view[2], *height / view[3]);
      place.translate(Vec2(-view[0], -view[1]));
      larger = std::max(view[2], view[3]) * unit;
    } else {
      larger = std::max(width.value_or(0), height.value_or(0));
    }
    if (!(unit > 0)) {
      return fail(ErrorCode::UnreadableInput, "The SVG has a width or height of 0.", "svg");
    }
    // y upwards.
    place = Eigen::Affine2d(Eigen::Scaling(unit, -unit)) * place;
    if (!(result_.tolerance > 0)) {
      result_.tolerance = std::max(kAutomaticTolerance * larger, kLeastTolerance);
    }
    result_.raw.unitInMm = unit;
    children(root, place, 0);
    for (const std::string& name : left_) {
      result_.raw.warnings.push_back(
          fmt::format("<{}> is left out: only shapes and paths count", name));
    }
    return std::move(result_.raw);
  }

 private:
  void children(const pugi::xml_node& parent, const Eigen::Affine2d& place, int depth) {
    if (depth > kDeepest) return;
    for (const pugi::xml_node& node : parent.children()) {
      if (node.type() == pugi::node_element) element(node, place, depth);
    }
  }

  void element(const pugi::xml_node& node, const Eigen::Affine2d& outer, int depth) {
    std::string_view name = node.name();
    if (const auto colon = name.find(':'); colon != std::string_view::npos) {
      if (name.substr(0, colon) != "svg") return;  // metadata of editors
      name.remove_prefix(colon + 1);
    }
    if (hidden(node)) return;
    const auto step = transformOf(node.attribute("transform").value());
    if (!step) {
      result_.raw.warnings.push_back(
          fmt::format("a <{}> with a transform that cannot be read is left out", name));
      return;
    }
    const Eigen::Affine2d place = outer * *step;
    if (name == "g" || name == "a" || name == "svg" || name == "switch") {
      children(node, place, depth + 1);
    } else if (name == "path") {
      const auto chains = chainsOfPath(node.attribute("d").value(), place, result_.tolerance);
      result_.raw.chains.insert(result_.raw.chains.end(), chains.begin(), chains.end());
    } else if (name == "line") {
      add({{value(node, "x1"), value(node, "y1")}, {value(node, "x2"), value(node, "y2")}}, false,
          place);
    } else if (name == "polyline" || name == "polygon") {
      NumberReader reader{node.attribute("points").value()};
      std::vector<Vec2> points;
      while (const auto x = reader.number()) {
        const auto y = reader.number();
        if (!y) break;
        points.emplace_back(*x, *y);
      }
      add(points, name == "polygon", place);
    } else if (name == "rect") {
      rectangle(node, place);
    } else if (name == "circle") {
      const double r = value(node, "r");
      ellipse(Vec2(value(node, "cx"), value(node, "cy")), r, r, place);
    } else if (name == "ellipse") {
      ellipse(Vec2(value(node, "cx"), value(node, "cy")), value(node, "rx"), value(node, "ry"),
              place);
    } else if (name == "text" || name == "image" || name == "use" || name == "foreignObject") {
      left_.insert(std::string(name));
    }
  }

  static bool hidden(const pugi::xml_node& node) {
    const std::string_view style = node.attribute("style").value();
    return std::strcmp(node.attribute("display").value(), "none") == 0 ||
           std::strcmp(node.attribute("visibility").value(), "hidden") == 0 ||
           style.find("display:none") != std::string_view::npos ||
           style.find("visibility:hidden") != std::string_view::npos;
  }

  /// In user units: a length with a unit is so many pixels.
  static double value(const pugi::xml_node& node, const char* name) {
    return lengthIn(node.attribute(name).value()).value_or(0) / kPixel;
  }

  void add(const std::vector<Vec2>& points, bool closed, const Eigen::Affine2d& place) {
    Chain chain;
    chain.closed = closed;
    for (const Vec2& p : points) chain.points.push_back(place * p);
    result_.raw.chains.push_back(std::move(chain));
  }

  void ellipse(const Vec2& centre, double rx, double ry, const Eigen::Affine2d& place) {
    if (!(rx > 0) || !(ry > 0)) return;
    Chain chain;
    chain.closed = true;
    chain.points =
        ellipseArc(place * centre, place.linear() * Vec2(rx, 0), place.linear() * Vec2(0, ry), 0,
                   2 * std::numbers::pi, result_.tolerance);
    chain.points.pop_back();
    result_.raw.chains.push_back(std::move(chain));
  }

  void rectangle(const pugi::xml_node& node, const Eigen::Affine2d& place) {
    const double x = value(node, "x");
    const double y = value(node, "y");
    const double w = value(node, "width");
    const double h = value(node, "height");
    if (!(w > 0) || !(h > 0)) return;
    const bool hasX = node.attribute("rx") != nullptr;
    const bool hasY = node.attribute("ry") != nullptr;
    const double rx = std::clamp(value(node, hasX ? "rx" : "ry"), 0.0, w / 2);
    const double ry = std::clamp(value(node, hasY ? "ry" : "rx"), 0.0, h / 2);
    if (rx == 0 || ry == 0) {
      add({{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}}, true, place);
      return;
    }
    const std::string d = fmt::format(
        "M{},{}H{}A{},{} 0 0 1 {},{}V{}A{},{} 0 0 1 {},{}H{}A{},{} 0 0 1 {},{}V{}A{},{} 0 0 1 "
        "{},{}Z",
        x + rx, y, x + w - rx, rx, ry, x + w, y + ry, y + h - ry, rx, ry, x + w - rx, y + h, x + rx,
        rx, ry, x, y + h - ry, y + ry, rx, ry, x + rx, y);
    const auto chains = chainsOfPath(d, place, result_.tolerance);
    result_.raw.chains.insert(result_.raw.chains.end(), chains.begin(), chains.end());
  }

  struct {
    RawDrawing raw;
    double tolerance = 0;
  } result_;
  std::set<std::string> left_;
};

}  // namespace

Result<RawDrawing> readSvg(const std::string& text, double tolerance) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  if (!parsed) {
    return fail(ErrorCode::UnreadableInput,
                fmt::format("The SVG is not well-formed XML: {} near byte {}.",
                            parsed.description(), parsed.offset));
  }
  for (const pugi::xml_node& node : document.children()) {
    const std::string_view name = node.name();
    if (name == "svg" || name == "svg:svg") return SvgReader(tolerance).read(node);
  }
  return fail(ErrorCode::UnreadableInput, "The file holds no <svg> element.");
}

}  // namespace phront::cad
