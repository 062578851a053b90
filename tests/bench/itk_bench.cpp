// ITK's fast marching on the same problem.
#include <benchmark/benchmark.h>
#include <itkFastMarchingImageFilter.h>

#include "problems.h"
#include "ratio_reporter.h"

namespace phront::bench {
namespace {

void fastMarching(benchmark::State& state) {
  using Image = itk::Image<float, 3>;
  using Filter = itk::FastMarchingImageFilter<Image, Image>;
  const SphereProblem problem(kSweepNodes);
  std::int64_t nodes = 0;
  for (auto _ : state) {
    auto alive = Filter::NodeContainer::New();
    auto trial = Filter::NodeContainer::New();
    Filter::NodeContainer::ElementIdentifier count = 0;
    for (std::int32_t k = 0; k < kSweepNodes; ++k) {
      for (std::int32_t j = 0; j < kSweepNodes; ++j) {
        for (std::int32_t i = 0; i < kSweepNodes; ++i) {
          const double known =
              problem.known[static_cast<std::size_t>(problem.grid.number(i, j, k))];
          if (!std::isfinite(known)) continue;
          Filter::NodeType node;
          node.SetIndex({{i, j, k}});
          node.SetValue(static_cast<float>(known));
          trial->InsertElement(count++, node);
        }
      }
    }
    auto filter = Filter::New();
    filter->SetAlivePoints(alive);
    filter->SetTrialPoints(trial);
    filter->SetSpeedConstant(1);
    filter->SetOutputSize({{kSweepNodes, kSweepNodes, kSweepNodes}});
    Image::SpacingType spacing;
    spacing.Fill(problem.grid.spacing);
    filter->SetOutputSpacing(spacing);
    filter->Update();
    nodes += problem.grid.nodeCount();
  }
  state.SetItemsProcessed(nodes * 8);  // as if by a round of sweeps
}

const bool kRegistered = [] {
  benchmark::RegisterBenchmark("sweep/solve/itk_fast_marching", fastMarching)
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
  return true;
}();

const DeclareRatio kItk({"whole solution, single, to ITK FastMarching", "sweep/solve/phront_single",
                         "sweep/solve/itk_fast_marching", 1});

}  // namespace
}  // namespace phront::bench
