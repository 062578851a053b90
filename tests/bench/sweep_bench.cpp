// Distance on all nodes of a cube: the sweeping kernel, whole solutions, and the memory's roofline.
#include <benchmark/benchmark.h>

#include "fast_marching.h"
#include "field/godunov_tile.h"
#include "field/tile_layout.h"
#include "naive_sweep.h"
#include "phront/eikonal.h"
#include "problems.h"
#include "ratio_reporter.h"

namespace phront::bench {
namespace {

const SphereProblem& problem() {
  static const SphereProblem p(kSweepNodes);
  return p;
}
std::int64_t nodeSweeps(std::int64_t sweeps) { return problem().grid.nodeCount() * sweeps; }

template <class Real>
void naive(benchmark::State& state) {
  for (auto _ : state) {
    NaiveSweep<Real> sweep(problem());
    for (unsigned ordering = 0; ordering < 8; ++ordering) sweep.sweep(ordering);
    benchmark::DoNotOptimize(sweep.times().data());
  }
  state.SetItemsProcessed(state.iterations() * nodeSweeps(8));
}

/// Sweeps alone, of both kernels: nothing is skipped, nothing set up.
template <class Real>
void naiveKernel(benchmark::State& state) {
  NaiveSweep<Real> sweep(problem());
  for (auto _ : state) {
    for (unsigned ordering = 0; ordering < 8; ++ordering) sweep.sweep(ordering);
  }
  state.SetItemsProcessed(state.iterations() * nodeSweeps(8));
}

template <class Real>
void tileKernel(benchmark::State& state) {
  constexpr Index kTiles = kSweepNodes / 8;
  const auto layout = TileLayout<3>::dense({kSweepNodes, kSweepNodes, kSweepNodes});
  std::vector<Real> values(static_cast<std::size_t>(layout.nodeCount()), kFar<Real>);
  values[values.size() / 2] = 0;
  const auto valuesOf = [&](Index tile) {
    return tile == kNone ? nullptr : values.data() + TileLayout<3>::kNodes * tile;
  };
  for (auto _ : state) {
    for (unsigned ordering = 0; ordering < 8; ++ordering) {
      const auto place = [&](Index n, unsigned axis) {
        return (ordering >> axis & 1U) != 0 ? kTiles - 1 - n : n;
      };
      // Tiles as they follow each other in memory: the last axis is the fastest.
      for (Index a = 0; a < kTiles; ++a) {
        for (Index b = 0; b < kTiles; ++b) {
          for (Index c = 0; c < kTiles; ++c) {
            const Index tile = (place(a, 0) * kTiles + place(b, 1)) * kTiles + place(c, 2);
            TileView<Real, 3> view;
            view.values = valuesOf(tile);
            for (int side = 0; side < 6; ++side) {
              view.neighbours[static_cast<std::size_t>(side)] =
                  valuesOf(layout.neighbour(tile, side / 2, side % 2));
            }
            benchmark::DoNotOptimize(sweepTile(view, ordering, Real(0)));
          }
        }
      }
    }
  }
  state.SetItemsProcessed(state.iterations() * nodeSweeps(8));
}

void solve(benchmark::State& state, EikonalOptions options) {
  for (auto _ : state) {
    const auto solved = solveEikonal(problem().grid, problem().known, {}, options);
    benchmark::DoNotOptimize(solved->times.data());
  }
  // The work of one round, in however many sweeps it was done.
  state.SetItemsProcessed(state.iterations() * nodeSweeps(8));
}
void phrontDouble(benchmark::State& state) { solve(state, {.threads = 1}); }
void phrontSingle(benchmark::State& state) {
  solve(state, {.precision = EikonalPrecision::Single, .threads = 1});
}
void phrontSingleTwo(benchmark::State& state) {
  solve(state, {.precision = EikonalPrecision::Single, .threads = 2});
}
void marching(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(fastMarching(problem()).data());
  state.SetItemsProcessed(state.iterations() * nodeSweeps(8));
}

/// a = b + s c over arrays far larger than the caches (McCalpin's STREAM). Items: the node-sweeps
/// in single precision that this traffic would be, a read and a write of 4 bytes each.
void triad(benchmark::State& state) {
  constexpr std::size_t kCount = 1 << 24;
  std::vector<double> a(kCount, 1);
  const std::vector<double> b(kCount, 2);
  const std::vector<double> c(kCount, 3);
  for (auto _ : state) {
    for (std::size_t i = 0; i < kCount; ++i) a[i] = b[i] + 3 * c[i];
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kCount) * 24 / 8);
}

BENCHMARK(naiveKernel<double>)->Name("sweep/kernel/naive_double")->Unit(benchmark::kMillisecond);
BENCHMARK(naiveKernel<float>)->Name("sweep/kernel/naive_single")->Unit(benchmark::kMillisecond);
BENCHMARK(tileKernel<double>)->Name("sweep/kernel/phront_double")->Unit(benchmark::kMillisecond);
BENCHMARK(tileKernel<float>)->Name("sweep/kernel/phront_single")->Unit(benchmark::kMillisecond);
BENCHMARK(naive<double>)->Name("sweep/solve/naive_double")->Unit(benchmark::kMillisecond);
BENCHMARK(phrontDouble)->Name("sweep/solve/phront_double")->Unit(benchmark::kMillisecond);
BENCHMARK(phrontSingle)->Name("sweep/solve/phront_single")->Unit(benchmark::kMillisecond);
BENCHMARK(phrontSingleTwo)
    ->Name("sweep/solve/phront_single_2_threads")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(marching)->Name("sweep/solve/fast_marching")->Unit(benchmark::kMillisecond);
BENCHMARK(triad)->Name("sweep/roofline")->Unit(benchmark::kMillisecond);

const DeclareRatio kKernelSingle({"sweeping kernel, single, to naive loop, double",
                                  "sweep/kernel/phront_single", "sweep/kernel/naive_double", 10});
const DeclareRatio kKernelDouble({"sweeping kernel, double, to naive loop, double",
                                  "sweep/kernel/phront_double", "sweep/kernel/naive_double", 1});
const DeclareRatio kSolveSingle({"whole solution, single, to naive loop, double",
                                 "sweep/solve/phront_single", "sweep/solve/naive_double", 1});
const DeclareRatio kSolveMarching({"whole solution, single, to fast marching",
                                   "sweep/solve/phront_single", "sweep/solve/fast_marching", 1});
const DeclareRatio kRoofline({"whole solution, single, to the memory's roofline",
                              "sweep/solve/phront_single", "sweep/roofline", 0.15});

}  // namespace
}  // namespace phront::bench
