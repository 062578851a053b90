#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>

#include "drawing/readers.h"
#include "exchange/cad_file.h"
#include "exchange/guard.h"

namespace phront::cad {
namespace {

using Json = nlohmann::json;

constexpr std::uintmax_t kMostBytes = 200'000'000;
constexpr double kJoinOfTolerance = 2;  // ends within twice the tolerance meet
constexpr double kAutomaticTolerance = 1e-5;

Result<std::string> textOf(const std::filesystem::path& path) {
  std::error_code error;
  const auto unreadable = [&](const std::string& why) {
    return fail(ErrorCode::UnreadableInput,
                fmt::format("{} cannot be read: {}.", path.string(), why));
  };
  if (!std::filesystem::exists(path, error)) return unreadable("there is no such file");
  if (std::filesystem::is_directory(path, error)) return unreadable("it is a folder");
  if (std::filesystem::file_size(path, error) > kMostBytes) return unreadable("it is too large");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return unreadable("permission denied");
  std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  if (text.empty()) return unreadable("it is empty");
  return text;
}

std::string bytesOf(const Drawing& d) {
  Json points = Json::array();
  for (const Vec2& p : d.curves.points) {
    points.push_back(p.x());
    points.push_back(p.y());
  }
  const Json json = Json::array(
      {points, d.curves.segments, d.curves.curveOf, d.unitInMm, d.loops, d.open, d.warnings});
  std::string bytes;
  Json::to_cbor(json, bytes);
  return bytes;
}

Drawing drawingOf(const std::string& bytes) {
  const Json json = Json::from_cbor(bytes);
  Drawing d;
  const auto coordinates = json.at(0).get<std::vector<double>>();
  for (std::size_t i = 0; i + 1 < coordinates.size(); i += 2) {
    d.curves.points.emplace_back(coordinates[i], coordinates[i + 1]);
  }
  json.at(1).get_to(d.curves.segments);
  json.at(2).get_to(d.curves.curveOf);
  json.at(3).get_to(d.unitInMm);
  json.at(4).get_to(d.loops);
  json.at(5).get_to(d.open);
  json.at(6).get_to(d.warnings);
  return d;
}

}  // namespace

Result<DrawingFormat> drawingFormatOf(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".svg") return DrawingFormat::Svg;
  if (extension == ".dxf") return DrawingFormat::Dxf;
  return fail(ErrorCode::InvalidArgument,
              fmt::format("{}: drawings are .svg or .dxf.", path.string()));
}

namespace {

/// Guarded work that ends with the curves of the file.
using ReadRaw = std::function<Result<RawDrawing>(double tolerance)>;

Result<std::string> readInChild(const std::filesystem::path& path, const DrawingOptions& options,
                                const ReadRaw& read) {
  auto raw = read(options.tolerance.value_or(0));
  if (!raw) return tl::unexpected(raw.error());
  Eigen::AlignedBox2d box;
  for (const Chain& c : raw->chains) {
    for (const Vec2& p : c.points) {
      if (!p.allFinite()) {
        return fail(ErrorCode::UnreadableInput, "A point of the drawing is not finite.");
      }
      box.extend(p);
    }
  }
  if (box.isEmpty() || !(box.diagonal().norm() > 0)) {
    return fail(ErrorCode::UnreadableInput, fmt::format("{} holds no curves.", path.string()));
  }
  const double join =
      kJoinOfTolerance * options.tolerance.value_or(kAutomaticTolerance * box.diagonal().norm());
  Drawing drawing = assemble(std::move(raw->chains), join);
  if (drawing.curves.segments.empty()) {
    return fail(ErrorCode::UnreadableInput,
                fmt::format("{} holds no curves of any length.", path.string()));
  }
  drawing.unitInMm = raw->unitInMm;
  drawing.warnings.insert(drawing.warnings.begin(), raw->warnings.begin(), raw->warnings.end());
  return bytesOf(drawing);
}

Result<Drawing> readGuarded(const std::filesystem::path& path, const DrawingOptions& options,
                            const ReadRaw& read) {
  const auto bytes =
      runInChild("reading " + path.filename().string(), {options.timeLimit, options.memoryLimit},
                 [&] { return readInChild(path, options, read); });
  if (!bytes && bytes.error().code == ErrorCode::Failed) {
    return fail(ErrorCode::UnreadableInput, bytes.error().message);
  }
  if (!bytes) return tl::unexpected(bytes.error());
  return drawingOf(*bytes);
}

}  // namespace

Result<Drawing> readDrawing(const std::filesystem::path& path, const DrawingOptions& options) {
  if (options.tolerance && !(*options.tolerance > 0 && std::isfinite(*options.tolerance))) {
    return fail(ErrorCode::InvalidArgument, "The tolerance must be positive and finite.",
                "tolerance");
  }
  if (shapeFormatOf(path)) {
    const auto file = openCadFile(path, options.memoryLimit);
    if (!file) return tl::unexpected(file.error());
    return readGuarded(path, options, [&](double tolerance) -> Result<RawDrawing> {
      const auto loaded = loadCadFile(path, *file);
      if (!loaded) return unreadable(path, loaded.error().message);
      auto raw = readWires(*loaded, tolerance);
      if (!raw) return unreadable(path, raw.error().message);
      return raw;
    });
  }
  const auto format = drawingFormatOf(path);
  if (!format) return tl::unexpected(format.error());
  const auto text = textOf(path);
  if (!text) return tl::unexpected(text.error());
  return readGuarded(path, options, [&](double tolerance) {
    return *format == DrawingFormat::Svg ? readSvg(*text, tolerance) : readDxf(*text, tolerance);
  });
}

}  // namespace phront::cad
