// Distance to a cube, inside and out, by fast sweeping (table 4.3 of the thesis).
#include <fmt/format.h>

#include "common/report.h"
#include "common/shapes.h"

using namespace thesis;

int main(int argc, char** argv) {
  const auto folder = outputFolder(argc, argv);
  const auto surface = orStop(phront::SurfaceDistance::build(cube(0.3, 1)));
  Table table(
      "cube of side 0.3 in a cube of side 0.5 (table 4.3)",
      "rms and max of ||phi| - exact| over the swept nodes; exact: distance to the triangles",
      {"h", "thesis rms", "ours rms", "thesis max", "ours max", "second order rms",
       "second order max", "sweeps"});
  struct Case {
    int cells;
    std::string rms;
    std::string max;
  };
  const std::vector<Case> cases{
      {25, "-", ".0224"}, {50, "-", ".0150"}, {100, "-", ".0095"}, {200, "-", ".0057"}};
  for (const Case& c : cases) {
    const double side = 0.5;
    const std::int32_t n = c.cells + 1;
    const phront::NodeGrid grid{{n, n, n}, side / c.cells, phront::Vec3::Constant(-side / 2)};
    const auto exact = orStop(phront::solveGridField(grid, surface));
    const auto solve = [&](phront::EikonalOrder order) {
      return orStop(phront::solveGridField(
          grid, surface, {.solver = phront::FieldSolver::Godunov, .order = order}));
    };
    const auto first = solve(phront::EikonalOrder::First);
    const Norms norms = errors(first, exact.phi);
    const Norms second = errors(solve(phront::EikonalOrder::Second), exact.phi);
    table.row({fmt::format("{:g}", grid.spacing), c.rms, fmt::format("{:.4f}", norms.rms), c.max,
               fmt::format("{:.4f}", norms.max), fmt::format("{:.4f}", second.rms),
               fmt::format("{:.4f}", second.max), fmt::format("{}", first.sweeps)});
  }
  table.print();
  table.writeCsv(folder / "cube_errors.csv");
}
