// The picture module draws meshes: lines become flat ribbons.
#include "common/figure.h"

#include <fmt/format.h>

#include <cstdio>
#include <string>

#include "common/report.h"
#include "phront/mesh_io.h"
#include "phront/picture.h"

namespace thesis {
namespace {

using phront::CurveMesh;
using phront::Index;
using phront::TriMesh;
using phront::Vec2;
using phront::Vec3;

constexpr double kRibbonOfBox = 0.0012;  // half width, of the diagonal
constexpr double kStrong = 2.5;          // times as thick

void addRibbon(const CurveMesh& curves, double halfWidth, Index face, TriMesh& mesh) {
  for (const auto& [a, b] : curves.segments) {
    const Vec2& p = curves.points[static_cast<std::size_t>(a)];
    const Vec2& q = curves.points[static_cast<std::size_t>(b)];
    const Vec2 along = halfWidth * (q - p).normalized();
    const Vec2 across(-along.y(), along.x());
    // Half a width longer at both ends: closes the wedge between neighbours.
    const auto first = static_cast<Index>(mesh.points.size());
    for (const Vec2& corner : {Vec2(p - along - across), Vec2(q + along - across),
                               Vec2(q + along + across), Vec2(p - along + across)}) {
      mesh.points.emplace_back(corner.x(), corner.y(), 0);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
    mesh.faceOf.insert(mesh.faceOf.end(), 2, face);
  }
}

}  // namespace

void writeFigure(const std::vector<Lines>& lines, const std::filesystem::path& path) {
  Eigen::AlignedBox2d box;
  std::string csv = "x,y,value,curve\n";
  for (const Lines& l : lines) {
    for (std::size_t s = 0; s < l.curves.segments.size(); ++s) {
      for (const Index end : l.curves.segments[s]) {
        const Vec2& p = l.curves.points[static_cast<std::size_t>(end)];
        box.extend(p);
        csv += fmt::format("{:.17g},{:.17g},{:.9g},{}\n", p.x(), p.y(), l.value,
                           l.curves.curve(static_cast<Index>(s)));
      }
    }
    csv += "\n";
  }
  orStop(phront::writeFileAtomically(path.string() + ".csv", csv));

  phront::PictureItem item;
  item.colorByFace = true;
  const double width = kRibbonOfBox * box.diagonal().norm();
  for (std::size_t n = 0; n < lines.size(); ++n) {
    addRibbon(lines[n].curves, (lines[n].strong ? kStrong : 1) * width, static_cast<Index>(n),
              item.mesh);
  }
  phront::PictureOptions options;
  options.width = 1200;
  options.height = 1200;
  options.view = Vec3(0, 0, 1);
  const std::vector<phront::PictureItem> items{std::move(item)};
  const auto drawn = phront::writePicture(items, path.string() + ".png", options);
  if (!drawn) fmt::print(stderr, "no picture: {}\n", drawn.error().message);
}

}  // namespace thesis
