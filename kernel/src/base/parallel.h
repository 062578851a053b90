// The one way phront uses threads.
#pragma once

#include <cstdint>
#include <functional>

namespace phront {

/// Runs body(begin, end) over disjoint chunks of [0, count). Results must be written by index, so
/// that they do not depend on the number of threads. threads: 0 all cores, 1 serial (no thread is
/// started, safe in a forked child). Ranges shorter than `grain` run serially.
void parallelFor(std::int64_t count, int threads, std::int64_t grain,
                 const std::function<void(std::int64_t begin, std::int64_t end)>& body);

}  // namespace phront
