// phront_bench: all benchmarks, five times in mixed order, and the ratios of their medians.
// Arguments are those of Google Benchmark.
#include <vector>

#include "ratio_reporter.h"

int main(int argc, char** argv) {
  // Before the user's own, which win.
  std::vector<char*> arguments{argv[0]};
  std::vector<std::string> defaults{
      "--benchmark_repetitions=5", "--benchmark_report_aggregates_only=true",
      "--benchmark_enable_random_interleaving=true", "--benchmark_min_time=0.2"};
  for (std::string& argument : defaults) arguments.push_back(argument.data());
  arguments.insert(arguments.end(), argv + 1, argv + argc);
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;
  phront::bench::RatioReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}
