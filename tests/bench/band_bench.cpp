// Exact signed distance in a band of three spacings around meshes: field alone, and with the tree.
#include <benchmark/benchmark.h>

#include <string>

#include "band_problems.h"
#include "phront/distance_field.h"
#include "ratio_reporter.h"

namespace phront::bench {
namespace {

DistanceField fieldOf(const SurfaceDistance& surface, double h, int threads) {
  auto field = solveDistanceField(
      surface, {.spacing = h, .bandMin = -3 * h, .bandMax = 3 * h, .threads = threads});
  return std::move(*field);
}

void field(benchmark::State& state, const BandProblem& p, int threads) {
  const auto surface = SurfaceDistance::build(p.mesh);
  std::int64_t nodes = 0;
  for (auto _ : state)
    nodes += static_cast<std::int64_t>(fieldOf(*surface, p.h, threads).values().size());
  state.SetItemsProcessed(nodes);
  const DistanceField held = fieldOf(*surface, p.h, threads);
  state.counters["bytes/node"] =
      static_cast<double>(held.memory()) / static_cast<double>(held.values().size());
}

void meshToField(benchmark::State& state, const BandProblem& p) {
  std::int64_t nodes = 0;
  for (auto _ : state) {
    const auto surface = SurfaceDistance::build(p.mesh);
    nodes += static_cast<std::int64_t>(fieldOf(*surface, p.h, 1).values().size());
  }
  state.SetItemsProcessed(nodes);
}

const bool kRegistered = [] {
  for (const BandProblem& p : bandProblems()) {
    const auto name = [&](const char* who) { return "band/" + p.name + "/" + who; };
    const auto add = [&](const char* who, auto... arguments) {
      benchmark::RegisterBenchmark(name(who).c_str(), arguments...)
          ->Unit(benchmark::kMillisecond)
          ->UseRealTime();
    };
    add("phront", field, std::cref(p), 1);
    add("phront_2_threads", field, std::cref(p), 2);
    add("phront_with_tree", meshToField, std::cref(p));
    const double wanted = p.isSphere ? 4 : 2;
    DeclareRatio(
        {"exact band, " + p.name + ", to OpenVDB", name("phront"), name("openvdb"), wanted});
    DeclareRatio(
        {"the same with the tree of triangles", name("phront_with_tree"), name("openvdb"), wanted});
    DeclareRatio({"the same, two threads to one", name("phront_2_threads"), name("phront"), 1.7});
  }
  return true;
}();

}  // namespace
}  // namespace phront::bench
