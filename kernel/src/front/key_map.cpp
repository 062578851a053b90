#include "front/key_map.h"

namespace phront {

namespace {

constexpr std::int64_t kKeyOffset = 1 << 20;
constexpr std::uint64_t kKeyMask = (1U << 21) - 1;
constexpr std::uint64_t kEmptyKey = ~std::uint64_t{0};

std::size_t hashKey(std::uint64_t key) {
  key ^= key >> 31;
  key *= 0x9e3779b97f4a7c15ULL;  // Fibonacci hashing (Knuth)
  return static_cast<std::size_t>(key ^ (key >> 29));
}

}  // namespace

std::uint64_t packKey(const GridIndex& index) {
  std::uint64_t key = 0;
  for (int a = 2; a >= 0; --a) {
    const std::int64_t shifted = std::int64_t{index[static_cast<std::size_t>(a)]} + kKeyOffset;
    key = (key << 21U) | (static_cast<std::uint64_t>(shifted) & kKeyMask);
  }
  return key;
}

KeyMap::KeyMap() : keys_(1024, kEmptyKey), values_(1024, kNone) {}

/// Where the key is, or would be.
std::size_t KeyMap::slotOf(std::uint64_t key) const {
  const std::size_t mask = keys_.size() - 1;
  std::size_t slot = hashKey(key) & mask;
  while (keys_[slot] != key && keys_[slot] != kEmptyKey) slot = (slot + 1) & mask;
  return slot;
}

Index KeyMap::find(std::uint64_t key) const {
  const std::size_t slot = slotOf(key);
  return keys_[slot] == key ? values_[slot] : kNone;
}

Index KeyMap::insert(std::uint64_t key, Index value) {
  if (2 * (used_ + 1) > keys_.size()) grow();
  const std::size_t slot = slotOf(key);
  if (keys_[slot] == key) return values_[slot];
  keys_[slot] = key;
  values_[slot] = value;
  ++used_;
  return value;
}

void KeyMap::assign(std::uint64_t key, Index value) {
  if (insert(key, value) != value) values_[slotOf(key)] = value;
}

void KeyMap::grow() {
  std::vector<std::uint64_t> keys(2 * keys_.size(), kEmptyKey);
  std::vector<Index> values(keys.size(), kNone);
  keys.swap(keys_);
  values.swap(values_);
  const std::size_t mask = keys_.size() - 1;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (keys[i] == kEmptyKey) continue;
    std::size_t slot = hashKey(keys[i]) & mask;
    while (keys_[slot] != kEmptyKey) slot = (slot + 1) & mask;
    keys_[slot] = keys[i];
    values_[slot] = values[i];
  }
}

}  // namespace phront
