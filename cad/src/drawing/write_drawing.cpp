#include <fmt/format.h>

#include "phront/cad/drawing.h"
#include "phront/mesh_io.h"

namespace phront::cad {
namespace {

struct Line {
  std::vector<Vec2> points;
  bool closed = false;
};

/// The curves one after the other; segments of a curve follow one another.
std::vector<Line> linesOf(const CurveMesh& mesh) {
  std::vector<Line> lines;
  Index expected = kNone;
  Index first = kNone;
  const auto point = [&](Index i) { return mesh.points[static_cast<std::size_t>(i)]; };
  for (const auto& [a, b] : mesh.segments) {
    if (a != expected) {
      lines.push_back({{point(a)}, false});
      first = a;
    }
    lines.back().closed = b == first;
    if (b != first) lines.back().points.push_back(point(b));
    expected = b == first ? kNone : b;
  }
  return lines;
}

std::string svgOf(const CurveMesh& curves) {
  Eigen::AlignedBox2d box;
  for (const Vec2& p : curves.points) box.extend(p);
  if (box.isEmpty()) box.extend(Vec2(0, 0));
  const Vec2 low = box.min();
  const Vec2 size = box.sizes();
  // y downwards; one user unit is 1 mm.
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.12g}mm\" height=\"{:.12g}mm\" "
      "viewBox=\"{:.12g} {:.12g} {:.12g} {:.12g}\">\n"
      "<path fill=\"none\" stroke=\"black\" stroke-width=\"{:.3g}\" d=\"",
      size.x(), size.y(), low.x(), -box.max().y(), size.x(), size.y(), 1e-3 * size.norm());
  for (const Line& line : linesOf(curves)) {
    char command = 'M';
    for (const Vec2& p : line.points) {
      text += fmt::format("{}{:.12g},{:.12g}", command, p.x(), -p.y());
      command = 'L';
    }
    text += line.closed ? "Z\n" : "\n";
  }
  return text + "\"/>\n</svg>\n";
}

std::string dxfOf(const CurveMesh& curves) {
  // The smallest DXF that programs agree on: R12, POLYLINE; $INSUNITS 4: mm.
  std::string text =
      "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n"
      "0\nSECTION\n2\nENTITIES\n";
  for (const Line& line : linesOf(curves)) {
    text +=
        fmt::format("0\nPOLYLINE\n8\n0\n66\n1\n70\n{}\n10\n0\n20\n0\n30\n0\n", line.closed ? 1 : 0);
    for (const Vec2& p : line.points) {
      text += fmt::format("0\nVERTEX\n8\n0\n10\n{:.12g}\n20\n{:.12g}\n30\n0\n", p.x(), p.y());
    }
    text += "0\nSEQEND\n8\n0\n";
  }
  return text + "0\nENDSEC\n0\nEOF\n";
}

}  // namespace

Result<void> writeDrawing(const CurveMesh& curves, const std::filesystem::path& path) {
  const auto format = drawingFormatOf(path);
  if (!format) return tl::unexpected(format.error());
  return writeFileAtomically(path, *format == DrawingFormat::Svg ? svgOf(curves) : dxfOf(curves));
}

}  // namespace phront::cad
