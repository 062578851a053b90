// Grid coordinates as keys, and a map from keys to numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "phront/distance_field.h"
#include "phront/types.h"

namespace phront {

/// Grid coordinates (each within -2^20 .. 2^20 - 1) in one number that sorts by z, y, x.
[[nodiscard]] std::uint64_t packKey(const GridIndex& index);

/// Open-addressing map from keys to a number; no iteration, so no order. No key is ~0.
class KeyMap {
 public:
  KeyMap();
  /// Number stored for the key, or kNone.
  [[nodiscard]] Index find(std::uint64_t key) const;
  /// Stores `value` unless the key is there; returns the stored number.
  Index insert(std::uint64_t key, Index value);
  /// Stores `value` whatever is there.
  void assign(std::uint64_t key, Index value);

 private:
  void grow();
  [[nodiscard]] std::size_t slotOf(std::uint64_t key) const;
  std::vector<std::uint64_t> keys_;
  std::vector<Index> values_;
  std::size_t used_ = 0;
};

}  // namespace phront
