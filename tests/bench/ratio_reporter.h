// Google Benchmark's console report, and at its end the speeds of pairs of benchmarks compared.
#pragma once

#include <benchmark/benchmark.h>

#include <map>
#include <string>
#include <vector>

namespace phront::bench {

/// "`ours` does `wanted` times the items a second of `other`"; items that are both things of the
/// same kind: nodes, node-sweeps, bytes.
struct Ratio {
  std::string what;
  std::string ours;
  std::string other;
  double wanted = 1;
  double itemsPerItem = 1;  ///< items of `other` that make one of `ours`
};

/// Ratios are declared beside the benchmarks, before main().
std::vector<Ratio>& ratios();
struct DeclareRatio {
  explicit DeclareRatio(Ratio ratio) { ratios().push_back(std::move(ratio)); }
};

class RatioReporter : public benchmark::ConsoleReporter {
 public:
  RatioReporter() : ConsoleReporter(OO_Tabular) {}
  void ReportRuns(const std::vector<Run>& runs) override;
  void Finalize() override;

 private:
  std::map<std::string, double> speed_;  ///< items per second, median
};

}  // namespace phront::bench
