// How an exact band grows with the grid: nodes, memory and time over five halvings of h, as a table
// and as a plot (SVG). Work and memory go with area / h^2.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <vector>

#include "../kernel/meshes.h"
#include "phront/distance_field.h"

namespace {

using namespace phront;

struct Row {
  double h = 0;
  double nodes = 0;
  double bytes = 0;
  double seconds = 0;
};

Row measure(const SurfaceDistance& surface, double h) {
  const auto start = std::chrono::steady_clock::now();
  const auto field = solveDistanceField(
      surface, {.spacing = h, .bandMin = -3 * h, .bandMax = 3 * h, .threads = 1});
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  return {h, static_cast<double>(field->values().size()), static_cast<double>(field->memory()),
          time.count()};
}

/// Both axes logarithmic; each curve relative to its first value, beside the laws of area and
/// volume.
void writePlot(const char* path, const std::vector<Row>& rows) {
  std::ofstream svg(path);
  const auto x = [&](double h) { return 60 + 100 * std::log2(rows.front().h / h); };
  const auto y = [&](double ratio) { return 380 - 27 * std::log2(ratio); };
  svg << R"(<svg xmlns="http://www.w3.org/2000/svg" width="560" height="420" font-family="sans-serif" font-size="12">)"
      << R"(<rect width="560" height="420" fill="white"/>)";
  const auto curve = [&](const char* name, const char* colour, const char* dash, int below,
                         auto value) {
    svg << "<polyline fill='none' stroke='" << colour << "' stroke-dasharray='" << dash
        << "' points='";
    for (const Row& row : rows)
      svg << x(row.h) << "," << y(value(row) / value(rows.front())) << " ";
    const Row& last = rows.back();
    svg << "'/><text x='" << x(last.h) + 6 << "' y='"
        << y(value(last) / value(rows.front())) + below << "' fill='" << colour << "'>" << name
        << "</text>";
  };
  curve("1/h&#179;", "#999999", "4", 0, [](const Row& r) { return std::pow(r.h, -3); });
  curve("1/h&#178;", "#999999", "4", -6, [](const Row& r) { return std::pow(r.h, -2); });
  curve("memory", "#1f77b4", "", 10, [](const Row& r) { return r.bytes; });
  curve("time", "#d62728", "", 0, [](const Row& r) { return r.seconds; });
  for (const Row& row : rows) {
    svg << "<text x='" << x(row.h) - 14 << "' y='400'>" << fmt::format("{:.4g}", row.h)
        << "</text>";
  }
  svg << "<text x='300' y='415'>h</text></svg>\n";
}

}  // namespace

int main(int argc, char** argv) {
  const auto surface = SurfaceDistance::build(test::icosphere(5));
  fmt::print("exact band of +-3 h around a unit sphere of {} triangles, one thread\n\n",
             surface->mesh().triangles.size());
  fmt::print("{:>9} {:>11} {:>9} {:>9}   {:>28}\n", "h", "nodes", "MiB", "s",
             "times the row before: memory, time");
  std::vector<Row> rows;
  for (double h = 0.04; h > 0.002; h /= 2) {
    rows.push_back(measure(*surface, h));
    const Row& row = rows.back();
    fmt::print("{:>9.4g} {:>11.0f} {:>9.1f} {:>9.3f}", row.h, row.nodes, row.bytes / (1 << 20),
               row.seconds);
    if (rows.size() > 1) {
      const Row& before = rows[rows.size() - 2];
      fmt::print("   {:>21.2f} {:>6.2f}", row.bytes / before.bytes, row.seconds / before.seconds);
    }
    fmt::print("\n");
  }
  if (argc > 1) writePlot(argv[1], rows);
  return 0;
}
