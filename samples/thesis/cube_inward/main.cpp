// A cube of side 0.5 advected inwards by 0.1 (tables 5.3 and 5.4 of the thesis).
#include <fmt/format.h>

#include <cmath>

#include "common/report.h"
#include "common/shapes.h"
#include "common/timing.h"
#include "phront/advect.h"
#include "phront/grid_advect.h"
#include "phront/iso_surface.h"
#include "phront/mesh_io.h"

using namespace thesis;
using phront::Vec3;

namespace {

constexpr double kSide = 0.5;
constexpr double kDistance = -0.1;

/// How far a point lies off the surface of the cube of side 0.3.
double offSurface(const Vec3& x) {
  const Vec3 beyond = x.cwiseAbs() - Vec3::Constant(kSide / 2 + kDistance);
  return std::abs(beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0));
}

}  // namespace

int main(int argc, char** argv) {
  const auto folder = outputFolder(argc, argv);
  const phront::TriMesh mesh = cube(kSide, 10);
  const auto surface = orStop(phront::SurfaceDistance::build(mesh));
  Table table(
      "cube of side 0.5, 10 x 10 squares a side, inwards by 0.1 (tables 5.3, 5.4)",
      "L2: rms over the nodes that do not collide of the distance to the cube of side 0.3; "
      "frame of side 0.6; nodes on edges and corners run into the medial axis; seconds on one "
      "thread, iso: phi = -0.1 as a surface, from exact values of its own at the same h",
      {"nodes", "thesis L2", "ours L2", "arrived", "collided", "exact scheme L2", "seed s",
       "sweep s", "iso s", "advect s"});
  const auto rms = [&](const phront::AdvectResult& moved) {
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < moved.points.size(); ++i) {
      if (moved.status[i] != phront::AdvectStatus::Arrived) continue;
      sum += std::pow(offSurface(moved.points[i]), 2);
      ++count;
    }
    return std::pair(count > 0 ? std::sqrt(sum / count) : 0, count);
  };
  const auto exact = orStop(phront::advectMesh(surface, {.distance = kDistance}));
  const std::vector<std::pair<int, std::string>> cases{
      {21, ".027"}, {41, "-"}, {81, "-"}, {161, ".0086"}};
  for (const auto& [n, printed] : cases) {
    const double side = 0.6;
    const phront::NodeGrid grid{{n, n, n}, side / (n - 1), Vec3::Constant(-side / 2)};
    const TimedField timed = sweepTimed(grid, surface);
    Stopwatch watch;
    (void)orStop(phront::isoSurface(
        surface,
        {.level = kDistance, .spacing = grid.spacing, .mostRefinedNodes = 0, .threads = 1}));
    const double iso = watch.lap();
    const auto moved = orStop(phront::advectOnGrid(grid, timed.field.phi, mesh.points,
                                                   {.distance = kDistance, .threads = 1}));
    const double advect = watch.lap();
    const auto [error, arrived] = rms(moved);
    table.row({fmt::format("{0} x {0} x {0}", n), printed, fmt::format("{:.4f}", error),
               fmt::format("{}", arrived),
               fmt::format("{}", static_cast<int>(mesh.points.size()) - arrived),
               fmt::format("{:.2g}", rms(exact).first), fmt::format("{:.3f}", timed.seed),
               fmt::format("{:.3f}", timed.sweep), fmt::format("{:.3f}", iso),
               fmt::format("{:.3f}", advect)});
    if (n != 81) continue;
    phront::TriMesh inner = mesh;
    inner.points = moved.points;
    orStop(phront::writeMesh(inner, folder / "cube_inward.vtu"));
  }
  table.print();
  table.writeCsv(folder / "cube_inward_errors.csv");
}
