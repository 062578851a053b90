#include "ratio_reporter.h"

#include <fmt/format.h>

namespace phront::bench {

std::vector<Ratio>& ratios() {
  static std::vector<Ratio> all;
  return all;
}

void RatioReporter::ReportRuns(const std::vector<Run>& runs) {
  for (const Run& run : runs) {
    if (run.run_type == Run::RT_Aggregate && run.aggregate_name != "median") continue;
    const auto items = run.counters.find("items_per_second");
    if (items != run.counters.end()) speed_[run.run_name.function_name] = items->second;
  }
  ConsoleReporter::ReportRuns(runs);
}

void RatioReporter::Finalize() {
  ConsoleReporter::Finalize();
  fmt::print("\n{:<72} {:>8} {:>8}\n", "ratios of this run (medians)", "is", "wanted");
  for (const Ratio& ratio : ratios()) {
    const auto ours = speed_.find(ratio.ours);
    const auto other = speed_.find(ratio.other);
    if (ours == speed_.end() || other == speed_.end()) continue;  // filtered out, or no such peer
    const double is = ours->second * ratio.itemsPerItem / other->second;
    fmt::print("{:<72} {:>8.2f} {:>8.2f}\n", ratio.what, is, ratio.wanted);
  }
}

}  // namespace phront::bench
