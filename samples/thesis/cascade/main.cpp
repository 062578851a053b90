// Fronts around the blades of a turbine cascade (figure 4.7 of the thesis). The field is periodic
// by the pitch: one blade with its copies above and below; fronts of neighbours meet on the
// periodic lines and end there.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/figure.h"
#include "common/report.h"
#include "phront/iso_curve.h"

using namespace thesis;
using phront::CurveMesh;
using phront::Vec2;

namespace {

constexpr double kPitch = 0.7;
constexpr int kBladePoints = 200;

/// Thickness of the four-digit NACA family (Jacobs, Ward, Pinkerton 1933, closed trailing edge)
/// over a parabolic arc of camber, set at an angle.
CurveMesh blade() {
  const double thickness = 0.16;
  const double camber = 0.18;
  const double stagger = -0.5;
  const auto point = [&](double x, double side) {
    const double y = 5 * thickness *
                     (0.2969 * std::sqrt(x) - 0.1260 * x - 0.3516 * x * x + 0.2843 * x * x * x -
                      0.1036 * x * x * x * x);
    const double slope = 4 * camber * (1 - 2 * x);
    const double length = std::hypot(1.0, slope);
    const Vec2 p(x - side * y * slope / length, 4 * camber * x * (1 - x) + side * y / length);
    return Vec2(std::cos(stagger) * p.x() - std::sin(stagger) * p.y(),
                std::sin(stagger) * p.x() + std::cos(stagger) * p.y());
  };
  std::vector<Vec2> points;
  // Counter-clockwise from the trailing edge over the upper side; close together at both ends.
  for (int i = 0; i < 2 * kBladePoints; ++i) {
    const double angle = std::numbers::pi * i / kBladePoints;
    points.push_back(point(0.5 * (1 + std::cos(angle)), i < kBladePoints ? 1 : -1));
  }
  return phront::curveThrough(points, true);
}

}  // namespace

int main(int argc, char** argv) {
  const auto folder = outputFolder(argc, argv);
  CurveMesh blades;
  for (const int copy : {-2, -1, 0, 1, 2}) {
    CurveMesh shifted = blade();
    for (Vec2& p : shifted.points) p.y() += copy * kPitch;
    blades = copy == -2 ? shifted : phront::joined(blades, shifted);
  }
  const auto distance = orStop(phront::CurveDistance::build(blades));
  // The copies above and below are in the frame, so that the two pitches in its middle lack
  // nothing.
  const phront::NodeGrid grid{{321, 561, 1}, 0.005, phront::Vec3(-0.3, -1.6, 0)};
  const auto field = orStop(phront::solveGridField(
      grid, distance,
      {.solver = phront::FieldSolver::Godunov, .order = phront::EikonalOrder::Second}));
  const auto rows = static_cast<std::int32_t>(std::lround(kPitch / grid.spacing));
  const phront::NodeGrid middle{
      {grid.nodes[0], 2 * rows + 1, 1}, grid.spacing, grid.position(0, rows)};
  const auto from = field.phi.begin() + grid.number(0, rows);
  const std::vector<double> phi(from, from + middle.nodeCount());
  double shift = 0;
  for (std::int32_t j = 0; j <= rows; ++j) {
    for (std::int32_t i = 0; i < middle.nodes[0]; ++i) {
      const auto here = static_cast<std::size_t>(middle.number(i, j));
      const auto there = static_cast<std::size_t>(middle.number(i, j + rows));
      shift = std::max(shift, std::abs(phi[here] - phi[there]));
    }
  }
  Table table(
      "turbine cascade, pitch 0.7 of the chord (figure 4.7)",
      fmt::format("error: of the lines phi = level, against the exact distance; phi repeats "
                  "by the pitch to {:.2g} h",
                  shift / grid.spacing),
      {"level", "lines", "error / h"});
  std::vector<Lines> lines{{blade(), 0, true}};
  for (double level = 0.05; level < 0.45; level += 0.05) {
    const CurveMesh line = orStop(phront::isoCurve(middle, phi, level));
    double worst = 0;
    for (const Vec2& p : line.points) {
      worst = std::max(worst, std::abs(distance.foot(p).distance - level));
    }
    table.row({fmt::format("{:.2f}", level), fmt::format("{}", phront::curveCount(line)),
               fmt::format("{:.3f}", worst / grid.spacing)});
    lines.push_back({line, level});
  }
  table.print();
  table.writeCsv(folder / "cascade_levels.csv");
  writeFigure(lines, folder / "cascade");
}
