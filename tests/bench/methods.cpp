// The methods that the thesis reviews, side by side with ours: accuracy and time on one thread.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>

#include "../kernel/meshes.h"
#include "averaged_normals.h"
#include "fast_marching.h"
#include "level_set.h"
#include "naive_sweep.h"
#include "phront/advect.h"
#include "phront/eikonal.h"
#include "phront/surface_distance.h"

namespace {

using namespace phront;
using namespace phront::bench;

double secondsOf(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::vector<double> sweepNaively(const SphereProblem& problem) {
  NaiveSweep<double> sweep(problem);
  for (unsigned ordering = 0; ordering < 8; ++ordering) sweep.sweep(ordering);
  return sweep.times();
}

std::vector<double> solveOurs(const SphereProblem& problem, EikonalOptions options) {
  options.threads = 1;
  auto solved = solveEikonal(problem.grid, problem.known, {}, options);
  return std::move(solved->times);
}

void compareFields(std::int32_t nodes) {
  const SphereProblem first(nodes);
  SphereProblem second = first;  // the second order needs values on two layers of nodes
  for (std::int32_t k = 0, n = 0; k < nodes; ++k) {
    for (std::int32_t j = 0; j < nodes; ++j) {
      for (std::int32_t i = 0; i < nodes; ++i, ++n) {
        const double d = first.exact(i, j, k);
        if (d <= 2 * first.grid.spacing) second.known[static_cast<std::size_t>(n)] = d;
      }
    }
  }
  fmt::print("\ndistance outside a sphere (radius 0.3, unit cube), {0} x {0} x {0} nodes\n", nodes);
  fmt::print("{:<44} {:>10} {:>10} {:>9}\n", "method", "max / h", "rms / h", "s");
  const auto row = [&](const char* name, const std::function<std::vector<double>()>& method) {
    std::vector<double> times;
    const double seconds = secondsOf([&] { times = method(); });
    const auto error = first.errorOf(times);
    fmt::print("{:<44} {:>10.4f} {:>10.4f} {:>9.3f}\n", name, error.most, error.rms, seconds);
  };
  row("level set, evolved in time", [&] { return levelSetTimes(first); });
  row("fast marching, heap", [&] { return fastMarching(first); });
  row("fast sweeping, nested loops, one round", [&] { return sweepNaively(first); });
  row("phront, first order", [&] { return solveOurs(first, {}); });
  row("phront, first order, single precision",
      [&] { return solveOurs(first, {.precision = EikonalPrecision::Single}); });
  row("phront, second order", [&] { return solveOurs(second, {.order = EikonalOrder::Second}); });
}

/// How far moved points are from the offset, how many stopped at other fronts, and triangles that
/// turned over.
void offsetRow(const char* name, const SurfaceDistance& surface, const TriMesh& moved,
               const std::vector<bool>& stopped, double distance, double seconds) {
  double worst = 0;
  for (std::size_t i = 0; i < moved.points.size(); ++i) {
    if (!stopped[i])
      worst = std::max(worst, std::abs(surface.signedDistance(moved.points[i]) - distance));
  }
  int inverted = 0;
  for (const auto& t : surface.mesh().triangles) {
    const auto normalOf = [&](const TriMesh& mesh) {
      const auto p = [&](std::size_t k) { return mesh.points[static_cast<std::size_t>(t[k])]; };
      return Vec3((p(1) - p(0)).cross(p(2) - p(0)));
    };
    if (normalOf(moved).dot(normalOf(surface.mesh())) < 0) ++inverted;
  }
  fmt::print("{:<36} {:>14.2e} {:>9} {:>9} {:>9.3f}\n", name, worst / std::abs(distance),
             std::ranges::count(stopped, true), inverted, seconds);
}

void compareOffsets(const char* what, const TriMesh& mesh, double distance) {
  fmt::print("\n{}: {} points moved by {:g}\n", what, mesh.points.size(), distance);
  fmt::print("{:<36} {:>14} {:>9} {:>9} {:>9}\n", "method", "|phi - d| / d", "stopped", "inverted",
             "s");
  const auto surface = SurfaceDistance::build(mesh);
  std::vector<bool> stopped(mesh.points.size(), false);
  for (const int steps : {1, 20}) {
    TriMesh moved;
    const double seconds =
        secondsOf([&] { moved = marchAlongAveragedNormals(mesh, distance, steps); });
    offsetRow(fmt::format("averaged normals, {} steps", steps).c_str(), *surface, moved, stopped,
              distance, seconds);
  }
  TriMesh moved = mesh;
  const double seconds = secondsOf([&] {
    const auto landed = advectMesh(*surface, {.distance = distance, .threads = 1});
    if (!landed) return;
    moved.points = landed->points;
    for (std::size_t i = 0; i < stopped.size(); ++i)
      stopped[i] = landed->status[i] != AdvectStatus::Arrived;
  });
  offsetRow("phront, exact advection", *surface, moved, stopped, distance, seconds);
}

}  // namespace

int main() {
  for (const std::int32_t nodes : {65, 129}) compareFields(nodes);
  compareOffsets("torus, outwards", test::torus(2, 0.6, 160, 60), 0.5);
  compareOffsets("torus, inwards", test::torus(2, 0.6, 160, 60), -0.5);
  compareOffsets("torus, its hole closes", test::torus(2, 0.6, 160, 60), 1.6);
  return 0;
}
