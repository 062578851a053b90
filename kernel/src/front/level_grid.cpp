// Cells around a level by block descent.
//
// phi is 1-Lipschitz, so a cube with | |phi(centre)| - |d| | > half its diagonal holds no point
// with |phi| = |d|: octree descent from the whole box to blocks of 2^3 cells leaves only blocks
// near the level (the bound is as old as sphere tracing, Hart 1996). All nodes of those blocks get
// an exact phi. Signed values sharpen the bound on closed input; open shells use the unsigned one
// because the sign jumps at their borders. A closed iso-surface needs all four cells around each
// crossed grid edge. With consistent signs the bound guarantees them; signs of self-intersecting
// input may jump, so blocks are added until the property holds. Nodes beyond the grown box count as
// outside, which bounds that. Weak spot: blocks are kept for their centre's bound only, about twice
// the nodes a tight band needs.
#include "front/level_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/parallel.h"

namespace phront {

namespace {

constexpr std::int32_t kKeyOffset = 1 << 20;
constexpr std::uint64_t kKeyMask = (1U << 21) - 1;
constexpr std::uint64_t kEmptyKey = ~std::uint64_t{0};
constexpr std::int64_t kGrain = 256;
constexpr std::size_t kTellingBlocks = 100'000;
// Largest number of cells along one axis: keys have 21 bits, half of them for the sign.
constexpr double kMaxCellsPerAxis = 900'000;
// Shifts of the grid in cells, irrational: planes of ordinary parts do not fall on grid planes.
const Vec3 kShift(0.3819660112501051, 0.4142135623730951, 0.2679491924311227);
// Slack of the Lipschitz bound against round-off.
constexpr double kBoundSlack = 1 + 1e-9;

std::size_t hashKey(std::uint64_t key) {
  key ^= key >> 31;
  key *= 0x9e3779b97f4a7c15ULL;  // Fibonacci hashing (Knuth)
  return static_cast<std::size_t>(key ^ (key >> 29));
}

}  // namespace

KeyMap::KeyMap() : keys_(1024, kEmptyKey), values_(1024, kNone) {}

Index KeyMap::find(std::uint64_t key) const {
  const std::size_t mask = keys_.size() - 1;
  for (std::size_t slot = hashKey(key) & mask;; slot = (slot + 1) & mask) {
    if (keys_[slot] == key) return values_[slot];
    if (keys_[slot] == kEmptyKey) return kNone;
  }
}

Index KeyMap::insert(std::uint64_t key, Index value) {
  if (2 * (used_ + 1) > keys_.size()) grow();
  const std::size_t mask = keys_.size() - 1;
  for (std::size_t slot = hashKey(key) & mask;; slot = (slot + 1) & mask) {
    if (keys_[slot] == key) return values_[slot];
    if (keys_[slot] == kEmptyKey) {
      keys_[slot] = key;
      values_[slot] = value;
      ++used_;
      return value;
    }
  }
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

std::uint64_t packKey(const GridIndex& index) {
  std::uint64_t key = 0;
  for (int a = 2; a >= 0; --a) {
    const std::int64_t shifted = std::int64_t{index[static_cast<std::size_t>(a)]} + kKeyOffset;
    key = (key << 21U) | (static_cast<std::uint64_t>(shifted) & kKeyMask);
  }
  return key;
}

GridIndex unpackKey(std::uint64_t key) {
  GridIndex index{};
  for (std::size_t a = 0; a < 3; ++a) {
    index[a] = static_cast<std::int32_t>((key >> (21U * a)) & kKeyMask) - kKeyOffset;
  }
  return index;
}

/// Builds a LevelGrid; block b covers the cells 2b and 2b + 1 of each axis.
class LevelGridBuilder {
 public:
  LevelGridBuilder(const SurfaceDistance& surface, const LevelGridOptions& options,
                   const Progress& progress)
      : surface_(surface), options_(options), progress_(progress) {}

  Result<LevelGrid> run() {
    if (auto placed = placeGrid(); !placed) return tl::unexpected(placed.error());
    auto blocks = descend();
    if (!blocks) return tl::unexpected(blocks.error());
    std::vector<Block> fresh = std::move(*blocks);
    while (!fresh.empty()) {
      if (auto added = addBlocks(fresh); !added) return tl::unexpected(added.error());
      fresh = missingBlocks();
    }
    sortCells();
    return std::move(grid_);
  }

 private:
  struct Block {
    GridIndex index{};
    Index triangle = kNone;  // near the block: where queries start
  };

  Result<void> placeGrid() {
    const double h = options_.spacing;
    const Box3& box = surface_.box();
    grow_ = std::max(options_.level, 0.0);
    const Vec3 extent = box.sizes() + Vec3::Constant(2 * grow_);
    if (!(extent.maxCoeff() / h < kMaxCellsPerAxis)) {
      return fail(ErrorCode::ResourceLimit,
                  "the iso-surface's grid spacing is too fine for the box of the part; "
                  "ask for a larger spacing");
    }
    grid_.spacing_ = h;
    grid_.level_ = options_.level;
    grid_.origin_ = box.min() - Vec3::Constant(grow_) - h * (Vec3::Constant(2) + kShift);
    const double cells = extent.maxCoeff() / h + 6;
    rootLevel_ = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(cells)));
    return {};
  }

  [[nodiscard]] FootPoint query(const Vec3& x, Index hint) const {
    return hint == kNone ? surface_.foot(x) : surface_.footFrom(x, hint);
  }

  [[nodiscard]] double boundOf(const FootPoint& foot) const {
    return surface_.watertight() ? std::abs(foot.phi() - options_.level)
                             : std::abs(foot.distance - std::abs(options_.level));
  }

  /// Blocks of 2^3 cells that may hold the level, in fixed order.
  Result<std::vector<Block>> descend() {
    std::vector<Block> blocks{{GridIndex{0, 0, 0}, kNone}};
    for (int size = rootLevel_; size >= 1; --size) {
      const double edge = std::ldexp(grid_.spacing_, size);
      const double reach = 0.5 * std::sqrt(3.0) * edge * kBoundSlack;
      std::vector<char> keep(blocks.size(), 0);
      parallelFor(
          static_cast<std::int64_t>(blocks.size()), options_.threads, kGrain,
          [&](std::int64_t begin, std::int64_t end) {
            for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
              const GridIndex& b = blocks[i].index;
              const Vec3 centre = grid_.origin_ + edge * Vec3(b[0] + 0.5, b[1] + 0.5, b[2] + 0.5);
              const FootPoint foot = query(centre, blocks[i].triangle);
              keep[i] = boundOf(foot) <= reach ? 1 : 0;
              blocks[i].triangle = foot.triangle;
            }
          });
      std::vector<Block> next;
      for (std::size_t i = 0; i < blocks.size(); ++i) {
        if (keep[i] == 0) continue;
        if (size == 1) {
          next.push_back(blocks[i]);
          continue;
        }
        for (int child = 0; child < 8; ++child) {
          const GridIndex& b = blocks[i].index;
          next.push_back({{2 * b[0] + (child & 1), 2 * b[1] + ((child >> 1) & 1),
                           2 * b[2] + ((child >> 2) & 1)},
                          blocks[i].triangle});
        }
      }
      blocks = std::move(next);
      if (tooManyBlocks(size > 1 ? blocks.size() / 8 : blocks.size(), size)) return tooMany();
      if (!progress_.report(0.2 * (rootLevel_ - size + 1) / rootLevel_)) return cancelled();
    }
    return blocks;
  }

  /// Kept blocks of a size foretell the nodes: a surface has four times as many half as large, and
  /// about ten nodes for each of the smallest. Few blocks foretell nothing.
  [[nodiscard]] bool tooManyBlocks(std::size_t kept, int size) const {
    if (kept < kTellingBlocks) return false;
    const double nodes = 10 * std::ldexp(static_cast<double>(kept), 2 * (size - 1));
    return nodes > 1.5 * static_cast<double>(options_.maxNodes);
  }

  [[nodiscard]] static tl::unexpected<Error> tooMany() {
    return fail(ErrorCode::ResourceLimit,
                "the iso-surface needs more grid nodes than allowed; ask for a larger spacing");
  }
  [[nodiscard]] static tl::unexpected<Error> cancelled() {
    return fail(ErrorCode::Cancelled, "cancelled while sampling the field");
  }

  /// Evaluates the nodes of blocks and sorts their cells into crossed and quiet ones.
  Result<void> addBlocks(const std::vector<Block>& fresh) {
    const auto first = grid_.nodes_.size();
    std::vector<Block> added;
    for (const Block& block : fresh) {
      if (blocks_.insertNew(packKey(block.index))) added.push_back(block);
    }
    for (const Block& block : added) {
      for (int n = 0; n < 27; ++n) {
        const GridIndex at{2 * block.index[0] + n % 3, 2 * block.index[1] + (n / 3) % 3,
                           2 * block.index[2] + n / 9};
        const auto number = static_cast<Index>(grid_.nodes_.size());
        if (nodeMap_.insert(packKey(at), number) != number) continue;
        grid_.nodeAt_.push_back(at);
        grid_.nodes_.emplace_back();
        grid_.nodes_.back().triangle = block.triangle;
      }
      if (static_cast<std::int64_t>(grid_.nodes_.size()) > options_.maxNodes) return tooMany();
    }
    const auto count = static_cast<std::int64_t>(grid_.nodes_.size() - first);
    constexpr std::int64_t kSlices = 16;  // cancellable between slices
    for (std::int64_t s = 0; s < kSlices; ++s) {
      const std::int64_t from = count * s / kSlices;
      const std::int64_t to = count * (s + 1) / kSlices;
      parallelFor(to - from, options_.threads, kGrain, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t i = begin; i < end; ++i) {
          evaluate(first + static_cast<std::size_t>(from + i));
        }
      });
      if (!progress_.report(0.2 + 0.8 * static_cast<double>(s + 1) / kSlices)) return cancelled();
    }
    for (const Block& block : added) collectCells(block);
    return {};
  }

  void evaluate(std::size_t i) {
    GridNode& node = grid_.nodes_[i];
    const Vec3 x = grid_.position(grid_.nodeAt_[i]);
    const FootPoint foot = query(x, node.triangle);
    const Box3& box = surface_.box();
    const double beyond = std::max((box.min() - x).maxCoeff(), (x - box.max()).maxCoeff());
    const bool outside = surface_.closed() && beyond > grow_ + 0.5 * grid_.spacing_;
    node.phi = outside ? foot.distance : foot.phi();
    node.foot = foot.point;
    node.triangle = foot.beyondBorder ? kNone : foot.triangle;
  }

  void collectCells(const Block& block) {
    for (int child = 0; child < 8; ++child) {
      GridCell cell;
      cell.lower = {2 * block.index[0] + (child & 1), 2 * block.index[1] + ((child >> 1) & 1),
                    2 * block.index[2] + ((child >> 2) & 1)};
      bool complete = true;
      for (int c = 0; c < 8; ++c) {
        const GridIndex at{cell.lower[0] + (c & 1), cell.lower[1] + ((c >> 1) & 1),
                           cell.lower[2] + ((c >> 2) & 1)};
        const Index node = nodeMap_.find(packKey(at));
        cell.node[static_cast<std::size_t>(c)] = node;
        const GridNode& data = grid_.nodes_[static_cast<std::size_t>(node)];
        if (data.triangle == kNone) complete = false;
        if (data.phi < options_.level) cell.inside |= static_cast<std::uint8_t>(1U << c);
      }
      if (!complete) continue;
      if (cell.inside == 0 || cell.inside == 255) {
        grid_.quietCells_.push_back(cell);
        continue;
      }
      grid_.cellMap_.insert(packKey(cell.lower), static_cast<Index>(grid_.cells_.size()));
      grid_.cells_.push_back(cell);
    }
  }

  /// Blocks of cells that share a crossed face with a known cell but are not there.
  [[nodiscard]] std::vector<Block> missingBlocks() {
    std::vector<Block> missing;
    for (; checked_ < grid_.cells_.size(); ++checked_) {
      const GridCell& cell = grid_.cells_[checked_];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 2; ++side) {
          if (!faceCrossed(cell.inside, axis, side)) continue;
          GridIndex lower = cell.lower;
          lower[axis] += 2 * side - 1;
          const GridIndex block{lower[0] >> 1, lower[1] >> 1, lower[2] >> 1};
          if (blocks_.map.find(packKey(block)) != kNone) continue;
          missing.push_back({block, grid_.nodes_[static_cast<std::size_t>(cell.node[0])].triangle});
        }
      }
    }
    return missing;
  }

  [[nodiscard]] static bool faceCrossed(unsigned inside, std::size_t axis, int side) {
    static constexpr std::array<unsigned, 3> kUpper{0xAA, 0xCC, 0xF0};
    const unsigned face = side == 1 ? kUpper[axis] : 0xFFU & ~kUpper[axis];
    const unsigned bits = inside & face;
    return bits != 0 && bits != face;
  }

  void sortCells() {
    std::ranges::sort(grid_.cells_, {}, [](const GridCell& c) { return packKey(c.lower); });
    std::ranges::sort(grid_.quietCells_, {}, [](const GridCell& c) { return packKey(c.lower); });
    grid_.cellMap_ = KeyMap();
    for (std::size_t i = 0; i < grid_.cells_.size(); ++i) {
      grid_.cellMap_.insert(packKey(grid_.cells_[i].lower), static_cast<Index>(i));
    }
  }

  /// A set on top of KeyMap.
  struct KeySet {
    KeyMap map;
    Index next = 0;
    bool insertNew(std::uint64_t key) {
      if (map.insert(key, next) != next) return false;
      ++next;
      return true;
    }
  };

  const SurfaceDistance& surface_;
  const LevelGridOptions& options_;
  const Progress& progress_;
  LevelGrid grid_;
  KeyMap nodeMap_;
  KeySet blocks_;
  double grow_ = 0;
  int rootLevel_ = 1;
  std::size_t checked_ = 0;
};

Result<LevelGrid> LevelGrid::build(const SurfaceDistance& surface, const LevelGridOptions& options,
                                   const Progress& progress) {
  return LevelGridBuilder(surface, options, progress).run();
}

}  // namespace phront
