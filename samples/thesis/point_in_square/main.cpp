// Distance to a point in the unit square, first and second order (table 4.1 of the thesis).
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "common/figure.h"
#include "common/report.h"
#include "phront/iso_curve.h"

using namespace thesis;

int main(int argc, char** argv) {
  const auto folder = outputFolder(argc, argv);
  const phront::Vec3 point(1 / std::sqrt(2.0), 1 / std::sqrt(3.0), 0);
  Table table("point in the unit square (table 4.1)",
              "rms and max of |phi - exact| over all nodes but the four of the point's cell",
              {"h", "thesis rms", "ours rms", "ours max", "second order rms", "sweeps"});
  const std::vector<std::pair<int, std::string>> cases{
      {50, ".0289"}, {100, ".0139"}, {200, ".0055"}, {400, ".0031"}};
  for (const auto& [cells, printed] : cases) {
    const phront::NodeGrid grid{{cells + 1, cells + 1, 1}, 1.0 / cells, phront::Vec3::Zero()};
    std::vector<double> known;
    std::vector<double> exact;
    for (std::int32_t j = 0; j <= cells; ++j) {
      for (std::int32_t i = 0; i <= cells; ++i) {
        const phront::Vec3 to = grid.position(i, j) - point;
        exact.push_back(to.norm());
        const bool ofCell = to.cwiseAbs().maxCoeff() < grid.spacing;
        known.push_back(ofCell ? exact.back() : std::numeric_limits<double>::infinity());
      }
    }
    const auto solve = [&](phront::EikonalOrder order) {
      auto solution = orStop(phront::solveEikonal(grid, known, {}, {.order = order}));
      phront::GridField field;
      for (const double value : known) field.seed.push_back(std::isfinite(value));
      field.phi = std::move(solution.times);
      field.sweeps = solution.sweeps;
      return field;
    };
    const phront::GridField first = solve(phront::EikonalOrder::First);
    const Norms norms = errors(first, exact);
    const Norms second = errors(solve(phront::EikonalOrder::Second), exact);
    table.row({fmt::format("{:g}", grid.spacing), printed, fmt::format("{:.4f}", norms.rms),
               fmt::format("{:.4f}", norms.max), fmt::format("{:.4f}", second.rms),
               fmt::format("{}", first.sweeps)});
    if (cells != 50) continue;
    std::vector<Lines> lines;
    for (double level = 0.05; level < 0.95; level += 0.05) {
      lines.push_back({orStop(phront::isoCurve(grid, first.phi, level)), level});
    }
    writeFigure(lines, folder / "point_in_square");
  }
  table.print();
  table.writeCsv(folder / "point_in_square_errors.csv");
}
