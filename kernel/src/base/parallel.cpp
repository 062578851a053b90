#include "base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_for_each.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <vector>

namespace phront {
namespace {

// More threads than cores gain nothing, and TBB would print a warning.
tbb::task_arena arenaOf(int threads) {
  const int cores = tbb::this_task_arena::max_concurrency();
  return tbb::task_arena(threads > 0 ? std::min(threads, cores) : tbb::task_arena::automatic);
}

}  // namespace

void parallelFor(std::int64_t count, int threads, std::int64_t grain,
                 const std::function<void(std::int64_t, std::int64_t)>& body) {
  if (count <= 0) return;
  if (threads == 1 || count <= grain) {
    body(0, count);
    return;
  }
  arenaOf(threads).execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, count, grain),
                      [&](const auto& range) { body(range.begin(), range.end()); });
  });
}

void parallelWorklist(std::span<const std::int32_t> first, int threads,
                      const std::function<void(std::int32_t, const AddItem&)>& body) {
  if (threads == 1) {
    std::vector<std::int32_t> waiting(first.rbegin(), first.rend());
    const AddItem add = [&](std::int32_t item) { waiting.push_back(item); };
    while (!waiting.empty()) {
      const std::int32_t item = waiting.back();
      waiting.pop_back();
      body(item, add);
    }
    return;
  }
  arenaOf(threads).execute([&] {
    tbb::parallel_for_each(first.begin(), first.end(),
                           [&](std::int32_t item, tbb::feeder<std::int32_t>& feeder) {
                             body(item, [&](std::int32_t next) { feeder.add(next); });
                           });
  });
}

}  // namespace phront
