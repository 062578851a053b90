// Fronts in a heat exchanger: pipes in a shell, with the three patterns of the shell (figures 4.9
// to 4.12 of the thesis): solid (fronts start from it, too), none (pipes alone), permeable (a wall
// that fronts neither start from nor pass).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/figure.h"
#include "common/report.h"
#include "common/shapes.h"
#include "phront/iso_curve.h"

using namespace thesis;
using phront::CurveMesh;
using phront::Vec2;

namespace {

constexpr double kShellRadius = 1;
constexpr double kPipeRadius = 0.12;
constexpr double kSpacing = 0.38;  // of the pipes, in rows of equal triangles
const double kInfinity = std::numeric_limits<double>::infinity();

CurveMesh pipes() {
  CurveMesh all;
  for (int row = -2; row <= 2; ++row) {
    for (int column = -3; column <= 3; ++column) {
      const Vec2 centre(kSpacing * (column + (row % 2 != 0 ? 0.5 : 0)),
                        kSpacing * row * std::sqrt(0.75));
      if (centre.norm() + kPipeRadius > 0.92 * kShellRadius) continue;
      const CurveMesh pipe = circle(centre, kPipeRadius, 120);
      all = all.points.empty() ? pipe : phront::joined(all, pipe);
    }
  }
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  const auto folder = outputFolder(argc, argv);
  const CurveMesh inner = pipes();
  CurveMesh shell = circle({0, 0}, kShellRadius, 720);
  for (auto& segment : shell.segments) std::swap(segment[0], segment[1]);  // material outside
  const auto pipeDistance = orStop(phront::CurveDistance::build(inner));
  const auto allDistance = orStop(phront::CurveDistance::build(phront::joined(inner, shell)));
  const phront::NodeGrid grid{{441, 441, 1}, 0.005, phront::Vec3(-1.1, -1.1, 0)};
  Table table(
      "heat exchanger: pipes of radius 0.12 in a shell of radius 1 (figures 4.9 to 4.12)",
      "lines of T = level in the fluid; error: against the exact distance to the pipes (and "
      "the solid shell), in h, where the straight way is free",
      {"shell", "level", "lines", "length", "error / h"});
  struct Pattern {
    std::string name;
    const phront::CurveDistance& sources;
    bool insideOnly;
  };
  for (const Pattern& pattern :
       {Pattern{"solid", allDistance, true}, Pattern{"none", pipeDistance, false},
        Pattern{"permeable", pipeDistance, true}}) {
    std::vector<double> known;
    std::vector<double> speed;
    for (std::int32_t j = 0; j < grid.nodes[1]; ++j) {
      for (std::int32_t i = 0; i < grid.nodes[0]; ++i) {
        const Vec2 x = grid.position(i, j).head<2>();
        const auto foot = pattern.sources.foot(x, 3 * grid.spacing);
        const bool fluid =
            pipeDistance.windingNumber(x) == 0 && (!pattern.insideOnly || x.norm() <= kShellRadius);
        known.push_back(fluid && foot.segment != phront::kNone ? foot.distance : kInfinity);
        speed.push_back(fluid ? 1 : 0);
      }
    }
    const auto solved =
        orStop(phront::solveEikonal(grid, known, speed, {.order = phront::EikonalOrder::Second}));
    std::vector<Lines> lines{{inner, 0, true}};
    if (pattern.insideOnly) lines.push_back({shell, 0, true});
    for (const double level : {0.02, 0.04, 0.06, 0.08, 0.12, 0.16}) {
      const CurveMesh line = orStop(phront::isoCurve(grid, solved.times, level));
      double worst = 0;
      for (const Vec2& p : line.points) {
        worst = std::max(worst, std::abs(pattern.sources.foot(p).distance - level));
      }
      table.row({pattern.name, fmt::format("{:g}", level),
                 fmt::format("{}", phront::curveCount(line)),
                 fmt::format("{:.3f}", phront::length(line)),
                 fmt::format("{:.3f}", worst / grid.spacing)});
      lines.push_back({line, level});
    }
    writeFigure(lines, folder / ("heat_exchanger_" + pattern.name));
  }
  table.print();
  table.writeCsv(folder / "heat_exchanger_levels.csv");
}
