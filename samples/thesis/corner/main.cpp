// Fronts of a right-angled corner, on both sides (figure 4.10 of the thesis): round where it is
// convex, sharp where it is concave.
#include <fmt/format.h>

#include <cmath>

#include "common/figure.h"
#include "common/report.h"
#include "phront/iso_curve.h"

using namespace thesis;

int main(int argc, char** argv) {
  const auto folder = outputFolder(argc, argv);
  const phront::CurveMesh corner = phront::curveThrough({{0, 0.4}, {0.3, 0.4}, {0.3, 0}}, false);
  const auto distance = orStop(phront::CurveDistance::build(corner));
  Table table("corner of 90 degrees in a frame of 0.6 x 0.8 (figure 4.10)",
              "error in h of the points of the lines phi = level against the exact distance",
              {"nodes", "level", "rms first", "max first", "rms second", "max second"});
  for (const int cells : {60, 240}) {
    const phront::NodeGrid grid{
        {cells + 1, cells * 4 / 3 + 1, 1}, 0.6 / cells, phront::Vec3::Zero()};
    const auto solve = [&](phront::EikonalOrder order) {
      return orStop(phront::solveGridField(
          grid, distance, {.solver = phront::FieldSolver::Godunov, .order = order}));
    };
    const auto first = solve(phront::EikonalOrder::First);
    const auto second = solve(phront::EikonalOrder::Second);
    std::vector<Lines> lines{{corner, 0, true}};
    for (const double level : {-0.2, -0.1, 0.1, 0.2}) {
      const auto error = [&](const phront::CurveMesh& line) {
        Norms norms;
        for (const phront::Vec2& p : line.points) {
          const double off = std::abs(distance.foot(p).distance - std::abs(level)) / grid.spacing;
          norms.rms += off * off / static_cast<double>(line.points.size());
          norms.max = std::max(norms.max, off);
        }
        norms.rms = std::sqrt(norms.rms);
        return norms;
      };
      const auto line = orStop(phront::isoCurve(grid, second.phi, level));
      const Norms a = error(orStop(phront::isoCurve(grid, first.phi, level)));
      const Norms b = error(line);
      table.row({fmt::format("{} x {}", grid.nodes[0], grid.nodes[1]), fmt::format("{:g}", level),
                 fmt::format("{:.3f}", a.rms), fmt::format("{:.3f}", a.max),
                 fmt::format("{:.3f}", b.rms), fmt::format("{:.3f}", b.max)});
      lines.push_back({line, level});
    }
    writeFigure(lines, folder / fmt::format("corner_{}x{}", grid.nodes[0], grid.nodes[1]));
  }
  table.print();
  table.writeCsv(folder / "corner_errors.csv");
}
