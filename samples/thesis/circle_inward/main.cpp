// A circle of radius 0.5, 39 segments, advected inwards by 0.1 (tables 5.1 and 5.2 of the thesis).
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "common/figure.h"
#include "common/report.h"
#include "common/shapes.h"
#include "common/timing.h"
#include "phront/grid_advect.h"
#include "phront/iso_curve.h"

using namespace thesis;
using phront::Vec3;

namespace {

constexpr double kRadius = 0.5;
constexpr double kDistance = -0.1;

}  // namespace

int main(int argc, char** argv) {
  const auto folder = outputFolder(argc, argv);
  const phront::CurveMesh polygon = circle({0, 0}, kRadius, 39);
  const auto distance = orStop(phront::CurveDistance::build(polygon));
  Table table(
      "circle of radius 0.5, 39 segments, inwards by 0.1 (tables 5.1, 5.2)",
      "L2: rms over the 39 corners of | |x| - 0.4 |; position: rms of |x - 0.8 x0|; frame of "
      "side 1.2; times of the first order on one thread, iso: the line phi = -0.1",
      {"nodes", "thesis L2", "ours L2", "position", "second order L2", "seed ms", "sweep ms",
       "iso ms", "advect ms"});
  const std::vector<std::pair<int, std::string>> cases{
      {21, ".0050"}, {41, "-"}, {81, "-"}, {161, "-"}, {321, ".0014"}};
  for (const auto& [n, printed] : cases) {
    const double side = 1.2;
    const phront::NodeGrid grid{{n, n, 1}, side / (n - 1), Vec3(-side / 2, -side / 2, 0)};
    std::vector<Vec3> start;
    for (const phront::Vec2& p : polygon.points) start.emplace_back(p.x(), p.y(), 0);
    struct Run {
      double radius = 0;
      double position = 0;
      std::vector<Vec3> points;
    };
    std::array<double, 4> seconds{};
    const auto run = [&](phront::EikonalOrder order) {
      const TimedField timed = sweepTimed(grid, distance, order);
      Stopwatch watch;
      const auto line = orStop(phront::isoCurve(grid, timed.field.phi, kDistance));
      const double iso = watch.lap();
      const auto moved = orStop(phront::advectOnGrid(grid, timed.field.phi, start,
                                                     {.distance = kDistance, .threads = 1}));
      seconds = {timed.seed, timed.sweep, iso, watch.lap()};
      Run result;
      for (std::size_t i = 0; i < start.size(); ++i) {
        result.radius += std::pow(moved.points[i].norm() - (kRadius + kDistance), 2);
        result.position +=
            (moved.points[i] - (kRadius + kDistance) / kRadius * start[i]).squaredNorm();
      }
      result.radius = std::sqrt(result.radius / static_cast<double>(start.size()));
      result.position = std::sqrt(result.position / static_cast<double>(start.size()));
      result.points = moved.points;
      if (n == 41 && order == phront::EikonalOrder::First) {
        std::vector<phront::Vec2> flat;
        for (const Vec3& p : moved.points) flat.emplace_back(p.x(), p.y());
        writeFigure(
            {{polygon, 0, true}, {line, kDistance}, {phront::curveThrough(flat, true), kDistance}},
            folder / "circle_inward");
      }
      return result;
    };
    const Run second = run(phront::EikonalOrder::Second);
    const Run first = run(phront::EikonalOrder::First);
    std::vector<std::string> row{
        fmt::format("{0} x {0}", n), printed, fmt::format("{:.4f}", first.radius),
        fmt::format("{:.4f}", first.position), fmt::format("{:.4f}", second.radius)};
    for (const double s : seconds) row.push_back(fmt::format("{:.2f}", 1000 * s));
    table.row(std::move(row));
  }
  table.print();
  table.writeCsv(folder / "circle_inward_errors.csv");
}
