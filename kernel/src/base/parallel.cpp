#include "base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace phront {

void parallelFor(std::int64_t count, int threads, std::int64_t grain,
                 const std::function<void(std::int64_t, std::int64_t)>& body) {
  if (count <= 0) return;
  if (threads == 1 || count <= grain) {
    body(0, count);
    return;
  }
  // More threads than cores gain nothing, and TBB would print a warning.
  const int cores = tbb::this_task_arena::max_concurrency();
  tbb::task_arena arena(threads > 0 ? std::min(threads, cores) : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, count, grain),
                      [&](const auto& range) { body(range.begin(), range.end()); });
  });
}

}  // namespace phront
