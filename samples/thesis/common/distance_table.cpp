#include "common/distance_table.h"

#include <fmt/format.h>

#include "common/report.h"

namespace thesis {

void distanceTable(const std::string& title, const phront::TriMesh& solid,
                   const std::vector<PrintedErrors>& printed, const std::filesystem::path& csv) {
  constexpr double kFrame = 0.5;
  const auto surface = orStop(phront::SurfaceDistance::build(solid));
  Table table(
      title,
      "rms and max of ||phi| - exact| over the swept nodes; exact: distance to the triangles",
      {"h", "thesis rms", "ours rms", "thesis max", "ours max", "second order rms",
       "second order max", "sweeps"});
  for (const PrintedErrors& line : printed) {
    const std::int32_t n = line.cells + 1;
    const phront::NodeGrid grid{
        {n, n, n}, kFrame / line.cells, phront::Vec3::Constant(-kFrame / 2)};
    const auto exact = orStop(phront::solveGridField(grid, surface));
    const auto solve = [&](phront::EikonalOrder order) {
      return orStop(phront::solveGridField(
          grid, surface, {.solver = phront::FieldSolver::Godunov, .order = order}));
    };
    const auto first = solve(phront::EikonalOrder::First);
    const Norms norms = errors(first, exact.phi);
    const Norms second = errors(solve(phront::EikonalOrder::Second), exact.phi);
    table.row({fmt::format("{:g}", grid.spacing), line.rms, fmt::format("{:.4f}", norms.rms),
               line.max, fmt::format("{:.4f}", norms.max), fmt::format("{:.4f}", second.rms),
               fmt::format("{:.4f}", second.max), fmt::format("{}", first.sweeps)});
  }
  table.print();
  table.writeCsv(csv);
}

}  // namespace thesis
