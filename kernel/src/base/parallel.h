// The one way phront uses threads.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

namespace phront {

/// Runs body(begin, end) over disjoint chunks of [0, count). Results must be written by index, so
/// that they do not depend on the number of threads. threads: 0 all cores, 1 serial (no thread is
/// started, safe in a forked child). Ranges shorter than `grain` run serially.
void parallelFor(std::int64_t count, int threads, std::int64_t grain,
                 const std::function<void(std::int64_t begin, std::int64_t end)>& body);

/// Runs body(item, add) on each first item and on each item that a body adds, as soon as it is
/// added and a thread is free; no item waits for a whole front of others. Who adds an item must
/// have seen all that it depends on done. threads as above.
using AddItem = std::function<void(std::int32_t item)>;
void parallelWorklist(std::span<const std::int32_t> first, int threads,
                      const std::function<void(std::int32_t item, const AddItem& add)>& body);

}  // namespace phront
