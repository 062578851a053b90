// Fronts of two tangent circles and of a loop that crosses itself (figure 4.6 of the thesis): they
// merge outside and split inside, and never cross.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "common/figure.h"
#include "common/report.h"
#include "common/shapes.h"
#include "phront/iso_curve.h"

using namespace thesis;
using phront::CurveMesh;
using phront::Vec2;

namespace {

CurveMesh limacon() {
  std::vector<Vec2> points;
  for (int i = 0; i < 720; ++i) {
    const double angle = 2 * std::numbers::pi * i / 720;
    points.emplace_back((0.5 + std::cos(angle)) * Vec2(std::cos(angle), std::sin(angle)));
  }
  return phront::curveThrough(points, true);
}

void fronts(const std::string& name, const CurveMesh& curves, const std::filesystem::path& folder) {
  const auto distance = orStop(phront::CurveDistance::build(curves));
  const int cells = 240;
  const double side = 4;
  const Vec2 middle = distance.box().center();
  const phront::NodeGrid grid{{cells + 1, cells + 1, 1},
                              side / cells,
                              phront::Vec3(middle.x() - side / 2, middle.y() - side / 2, 0)};
  const auto field = orStop(phront::solveGridField(
      grid, distance,
      {.solver = phront::FieldSolver::Godunov, .order = phront::EikonalOrder::Second}));
  Table table(name + " (figure 4.6)",
              "lines of phi = level; error: largest | |phi| - |level| | of their points, exact phi",
              {"level", "lines", "length", "error / h"});
  std::vector<Lines> lines{{curves, 0, true}};
  for (const double level : {-0.3, -0.2, -0.1, 0.1, 0.2, 0.3, 0.4}) {
    const CurveMesh line = orStop(phront::isoCurve(grid, field.phi, level));
    double worst = 0;
    for (const Vec2& p : line.points) {
      worst = std::max(worst, std::abs(distance.foot(p).distance - std::abs(level)));
    }
    table.row({fmt::format("{:g}", level), fmt::format("{}", phront::curveCount(line)),
               fmt::format("{:.4f}", phront::length(line)),
               fmt::format("{:.2g}", worst / grid.spacing)});
    lines.push_back({line, level});
  }
  table.print();
  table.writeCsv(folder / (name + "_levels.csv"));
  writeFigure(lines, folder / name);
}

}  // namespace

int main(int argc, char** argv) {
  const auto folder = outputFolder(argc, argv);
  fronts("tangent_circles", phront::joined(circle({-0.5, 0}, 0.5, 360), circle({0.5, 0}, 0.5, 360)),
         folder);
  fronts("crossing_loop", limacon(), folder);
}
