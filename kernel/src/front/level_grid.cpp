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
//
// Split cells lie beside whole ones, whose sides and edges then have nodes in their middles. What
// is shared is always the smaller one (the minimal edges of Ju, Losasso, Schaefer & Warren 2002),
// and a cell with an edge that the level crosses twice is split, too: the surface would pass it in
// a loop of two crossings, which no mesh of triangles can show.
#include "front/level_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/parallel.h"

namespace phront {

namespace {

constexpr std::int64_t kGrain = 256;
constexpr std::size_t kTellingBlocks = 100'000;
// Largest number of cells along one axis: keys have 21 bits, half of them for the sign.
constexpr double kMaxCellsPerAxis = 900'000;
// Shifts of the grid in cells, irrational: planes of ordinary parts do not fall on grid planes.
const Vec3 kShift(0.3819660112501051, 0.4142135623730951, 0.2679491924311227);
// Times that a cell can be halved, where the keys have room for it.
constexpr int kMostHalvings = 8;
// Slack of the Lipschitz bound against round-off.
constexpr double kBoundSlack = 1 + 1e-9;

void sortUnique(std::vector<Index>& numbers) {
  std::ranges::sort(numbers);
  const auto rest = std::ranges::unique(numbers);
  numbers.erase(rest.begin(), rest.end());
}

}  // namespace

bool LevelGrid::crossedAt(const Vec3& x) const {
  const Vec3 at = (x - origin_) / unit_;
  const GridIndex index{static_cast<std::int32_t>(std::floor(at[0])),
                        static_cast<std::int32_t>(std::floor(at[1])),
                        static_cast<std::int32_t>(std::floor(at[2]))};
  const auto sizeOf = [&](Index leaf) {
    const auto n = static_cast<std::size_t>(leaf);
    return n < cells_.size() ? cells_[n].size : quietCells_[n - cells_.size()].size;
  };
  const Index leaf = leafAt(index, sizeOf);
  return leaf != kNone && static_cast<std::size_t>(leaf) < cells_.size();
}

/// Builds a LevelGrid or makes it finer; block b covers the unsplit cells 2b and 2b + 1 of each
/// axis.
class LevelGridBuilder {
 public:
  LevelGridBuilder(LevelGrid& grid, const SurfaceDistance& surface, const LevelGridOptions& options,
                   const Progress& progress)
      : grid_(grid), surface_(surface), options_(options), progress_(progress) {}

  Result<void> build() {
    if (auto placed = placeGrid(); !placed) return placed;
    auto blocks = descend();
    if (!blocks) return tl::unexpected(blocks.error());
    if (auto added = addClosure(std::move(*blocks)); !added) return added;
    sortCells();
    return {};
  }

  Result<void> split(std::span<const Index> crossedCells, std::span<const Index> quietCells) {
    const auto crossed = static_cast<Index>(grid_.cells_.size());
    leaves_ = std::move(grid_.cells_);
    leaves_.insert(leaves_.end(), grid_.quietCells_.begin(), grid_.quietCells_.end());
    checked_ = leaves_.size();
    std::vector<Index> parents(crossedCells.begin(), crossedCells.end());
    for (const Index q : quietCells) {
      const GridCell& cell = leaves_[static_cast<std::size_t>(crossed + q)];
      forNeighbours(cell, true, [&](Index leaf) {
        const std::int32_t size = leaves_[static_cast<std::size_t>(leaf)].size;
        if (size > 1 && size >= cell.size) parents.push_back(leaf);
      });
    }
    while (!parents.empty()) {
      sortUnique(parents);
      if (auto made = makeChildren(parents); !made) return made;
      if (auto added = addClosure(missingBlocks()); !added) return added;
      parents = crossedTwice(besideOf(parents));
    }
    sortCells();
    return {};
  }

 private:
  struct Block {
    GridIndex index{};
    Index triangle = kNone;  // near the block: where queries start
  };

  Result<void> placeGrid() {
    const double h = options_.spacing;
    const Box3& box = surface_.box();
    grid_.grow_ = std::max(options_.level, 0.0);
    const Vec3 extent = box.sizes() + Vec3::Constant(2 * grid_.grow_);
    if (!(extent.maxCoeff() / h < kMaxCellsPerAxis)) {
      return fail(ErrorCode::ResourceLimit,
                  "the iso-surface's grid spacing is too fine for the box of the part; "
                  "ask for a larger spacing");
    }
    const double cells = extent.maxCoeff() / h + 6;
    int halvings = 0;
    while (halvings < kMostHalvings && std::ldexp(cells, halvings + 1) < kMaxCellsPerAxis) {
      ++halvings;
    }
    grid_.unit_ = std::ldexp(h, -halvings);
    grid_.coarse_ = grid_.finest_ = 1 << halvings;
    grid_.level_ = options_.level;
    grid_.origin_ = box.min() - Vec3::Constant(grid_.grow_) - h * (Vec3::Constant(2) + kShift);
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
      const double edge = std::ldexp(options_.spacing, size);
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

  /// Blocks with all others that the level reaches from them.
  Result<void> addClosure(std::vector<Block> fresh) {
    while (!fresh.empty()) {
      if (auto added = addBlocks(fresh); !added) return added;
      fresh = missingBlocks();
    }
    return {};
  }

  Result<void> addBlocks(const std::vector<Block>& fresh) {
    const std::size_t first = grid_.nodes_.size();
    std::vector<GridCell> cells;
    for (const Block& block : fresh) {
      if (!grid_.blocks_.insertNew(packKey(block.index))) continue;
      const std::int32_t side = 2 * grid_.coarse_;
      const GridIndex lower{side * block.index[0], side * block.index[1], side * block.index[2]};
      addCells(lower, grid_.coarse_, block.triangle, cells);
    }
    // Beside split cells or not: asking costs little.
    for (GridCell& cell : cells) cell.hanging = grid_.finest_ < grid_.coarse_;
    if (auto evaluated = evaluateFrom(first); !evaluated) return evaluated;
    collect(cells);
    return {};
  }

  Result<void> makeChildren(const std::vector<Index>& parents) {
    const std::size_t first = grid_.nodes_.size();
    std::vector<GridCell> cells;
    for (const Index number : parents) {
      GridCell& parent = leaves_[static_cast<std::size_t>(number)];
      const std::size_t before = cells.size();
      const auto corner = static_cast<std::size_t>(parent.node[0]);
      addCells(parent.lower, parent.size / 2, grid_.nodes_[corner].triangle, cells);
      for (std::size_t i = before; i < cells.size(); ++i) cells[i].hanging = parent.hanging;
      grid_.finest_ = std::min(grid_.finest_, parent.size / 2);
      split_.resize(leaves_.size(), 0);
      split_[static_cast<std::size_t>(number)] = 1;
    }
    if (auto evaluated = evaluateFrom(first); !evaluated) return evaluated;
    collect(cells);
    return {};
  }

  /// 2^3 cells of a size with their nodes, which are still to be evaluated.
  void addCells(const GridIndex& lower, std::int32_t size, Index triangle,
                std::vector<GridCell>& cells) {
    std::array<Index, 27> node{};
    for (int n = 0; n < 27; ++n) {
      const GridIndex at{lower[0] + size * (n % 3), lower[1] + size * ((n / 3) % 3),
                         lower[2] + size * (n / 9)};
      const auto number = static_cast<Index>(grid_.nodes_.size());
      const Index stored = grid_.nodeMap_.insert(packKey(at), number);
      node[static_cast<std::size_t>(n)] = stored;
      if (stored != number) continue;
      grid_.nodeAt_.push_back(at);
      grid_.nodes_.emplace_back();
      grid_.nodes_.back().triangle = triangle;
    }
    for (int child = 0; child < 8; ++child) {
      GridCell cell;
      cell.size = size;
      const std::array<int, 3> step{child & 1, (child >> 1) & 1, (child >> 2) & 1};
      for (std::size_t a = 0; a < 3; ++a) cell.lower[a] = lower[a] + size * step[a];
      for (int c = 0; c < 8; ++c) {
        const int n =
            step[0] + (c & 1) + 3 * (step[1] + ((c >> 1) & 1)) + 9 * (step[2] + ((c >> 2) & 1));
        cell.node[static_cast<std::size_t>(c)] = node[static_cast<std::size_t>(n)];
      }
      cells.push_back(cell);
    }
  }

  Result<void> evaluateFrom(std::size_t first) {
    if (static_cast<std::int64_t>(grid_.nodes_.size()) > options_.maxNodes) return tooMany();
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
    return {};
  }

  void evaluate(std::size_t i) {
    GridNode& node = grid_.nodes_[i];
    const Vec3 x = grid_.position(grid_.nodeAt_[i]);
    const FootPoint foot = query(x, node.triangle);
    const Box3& box = surface_.box();
    const double beyond = std::max((box.min() - x).maxCoeff(), (x - box.max()).maxCoeff());
    const bool outside = surface_.closed() && beyond > grid_.grow_ + 0.5 * options_.spacing;
    node.phi = outside ? foot.distance : foot.phi();
    node.foot = foot.point;
    node.triangle = foot.beyondBorder ? kNone : foot.triangle;
  }

  /// Takes cells with phi at all corners in.
  void collect(std::vector<GridCell>& cells) {
    for (GridCell& cell : cells) {
      bool complete = true;
      for (std::size_t c = 0; c < 8; ++c) {
        const GridNode& data = grid_.nodes_[static_cast<std::size_t>(cell.node[c])];
        if (data.triangle == kNone) complete = false;
        if (data.phi < options_.level) cell.inside |= static_cast<std::uint8_t>(1U << c);
      }
      if (!complete) continue;
      grid_.leafMap_.assign(packKey(cell.lower), static_cast<Index>(leaves_.size()));
      leaves_.push_back(cell);
    }
  }

  [[nodiscard]] Index leafAt(const GridIndex& at) const {
    return grid_.leafAt(at, [&](Index leaf) {
      const auto n = static_cast<std::size_t>(leaf);
      const bool isSplit = n < split_.size() && split_[n] != 0;  // with no child left there
      return isSplit ? 0 : leaves_[n].size;
    });
  }

  /// The block around a place beyond side 2a + s of a cell.
  [[nodiscard]] GridIndex blockBeyond(const GridCell& cell, std::size_t axis, int side) const {
    GridIndex at = cell.lower;
    at[axis] += side == 1 ? cell.size : -1;
    const int shift = std::countr_zero(static_cast<unsigned>(2 * grid_.coarse_));
    return {at[0] >> shift, at[1] >> shift, at[2] >> shift};
  }

  /// Blocks beyond a crossed side of a new cell that are not there.
  [[nodiscard]] std::vector<Block> missingBlocks() {
    std::vector<Block> missing;
    for (; checked_ < leaves_.size(); ++checked_) {
      const GridCell& cell = leaves_[checked_];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 2; ++side) {
          if (!faceCrossed(cell.inside, axis, side)) continue;
          const GridIndex block = blockBeyond(cell, axis, side);
          if (grid_.blocks_.map.find(packKey(block)) != kNone) continue;
          missing.push_back({block, grid_.nodes_[static_cast<std::size_t>(cell.node[0])].triangle});
        }
      }
    }
    return missing;
  }

  /// Calls visit(leaf) for the cells around one, with itself if wanted. Of cells smaller than this
  /// one not all come.
  template <class Visit>
  void forNeighbours(const GridCell& cell, bool itself, Visit&& visit) const {
    for (int n = 0; n < 27; ++n) {
      if (n == 13 && !itself) continue;
      const std::array<int, 3> step{n % 3 - 1, (n / 3) % 3 - 1, n / 9 - 1};
      GridIndex at = cell.lower;
      for (std::size_t a = 0; a < 3; ++a) at[a] += step[a] < 0 ? -1 : step[a] * cell.size;
      if (const Index leaf = leafAt(at); leaf != kNone) visit(leaf);
    }
  }

  /// Marks the cells that split ones have hung nodes on; gives these and the children of marked.
  [[nodiscard]] std::vector<Index> besideOf(const std::vector<Index>& parents) {
    std::vector<Index> touched;
    for (const Index number : parents) {
      const GridCell parent = leaves_[static_cast<std::size_t>(number)];
      forNeighbours(parent, false, [&](Index leaf) {
        GridCell& beside = leaves_[static_cast<std::size_t>(leaf)];
        if (beside.size < parent.size) return;
        beside.hanging = true;
        touched.push_back(leaf);
      });
      if (!parent.hanging) continue;
      for (int child = 0; child < 8; ++child) {
        const std::int32_t half = parent.size / 2;
        const Index leaf = leafAt({parent.lower[0] + half * (child & 1),
                                   parent.lower[1] + half * ((child >> 1) & 1),
                                   parent.lower[2] + half * ((child >> 2) & 1)});
        if (leaf != kNone) touched.push_back(leaf);
      }
    }
    return touched;
  }

  /// What the nodes on the boundary of a cell say.
  struct Boundary {
    bool complete = true;
    bool crossed = false;
    bool twice = false;  ///< an edge is crossed more than once
  };

  [[nodiscard]] Boundary boundaryOf(const GridCell& cell) const {
    Boundary found;
    const bool first = grid_.inside(cell.node[0]);
    const auto look = [&](Index node) {
      if (grid_.nodes_[static_cast<std::size_t>(node)].triangle == kNone) found.complete = false;
      if (grid_.inside(node) != first) found.crossed = true;
    };
    for (std::size_t face = 0; face < 6; ++face) {
      GridIndex lower = cell.lower;
      lower[face / 2] += face % 2 == 1 ? cell.size : 0;
      forSmallestSides(grid_, lower, cell.size, face / 2, true,
                       [&](const GridIndex& at, std::int32_t size) {
                         for (int corner = 0; corner < 4; ++corner) {
                           GridIndex node = at;
                           node[(face / 2 + 1) % 3] += (corner & 1) * size;
                           node[(face / 2 + 2) % 3] += (corner >> 1) * size;
                           look(grid_.findNode(node));
                         }
                       });
    }
    for (std::size_t edge = 0; edge < 12; ++edge) {
      const std::size_t axis = edge / 4;
      const std::size_t lower =
          ((edge & 1U) << ((axis + 1) % 3)) | (((edge >> 1U) & 1U) << ((axis + 2) % 3));
      int crossings = 0;
      forShortestEdges(grid_, cell.node[lower], cell.node[lower | (1U << axis)], cell.size, axis,
                       [&](Index low, Index high) {
                         look(low);
                         if (grid_.inside(low) != grid_.inside(high)) ++crossings;
                       });
      found.twice = found.twice || crossings > 1;
    }
    return found;
  }

  /// Those of the leaves that have an edge crossed twice.
  [[nodiscard]] std::vector<Index> crossedTwice(std::vector<Index> leaves) const {
    sortUnique(leaves);
    std::erase_if(leaves, [&](Index leaf) {
      return !boundaryOf(leaves_[static_cast<std::size_t>(leaf)]).twice;
    });
    return leaves;
  }

  [[nodiscard]] static bool faceCrossed(unsigned inside, std::size_t axis, int side) {
    static constexpr std::array<unsigned, 3> kUpper{0xAA, 0xCC, 0xF0};
    const unsigned face = side == 1 ? kUpper[axis] : 0xFFU & ~kUpper[axis];
    const unsigned bits = inside & face;
    return bits != 0 && bits != face;
  }

  /// Leaves into crossed and quiet ones. Nodes that hang on a cell's sides decide, too.
  void sortCells() {
    std::vector<GridCell> crossed;
    std::vector<GridCell> quiet;
    split_.resize(leaves_.size(), 0);
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
      if (split_[i] != 0) continue;
      const GridCell& cell = leaves_[i];
      const bool plain = cell.inside != 0 && cell.inside != 255;
      const Boundary found = cell.hanging ? boundaryOf(cell) : Boundary{true, plain, false};
      if (found.complete) (found.crossed ? crossed : quiet).push_back(cell);
    }
    grid_.leafMap_ = KeyMap();
    Index number = 0;
    for (std::vector<GridCell>* cells : {&crossed, &quiet}) {
      std::ranges::sort(*cells, {}, [](const GridCell& c) { return packKey(c.lower); });
      for (const GridCell& cell : *cells) grid_.leafMap_.assign(packKey(cell.lower), number++);
    }
    grid_.cells_ = std::move(crossed);
    grid_.quietCells_ = std::move(quiet);
  }

  LevelGrid& grid_;
  const SurfaceDistance& surface_;
  const LevelGridOptions& options_;
  const Progress& progress_;
  std::vector<GridCell> leaves_;  // in the order they came
  std::vector<char> split_;       // of each leaf that is none any more
  int rootLevel_ = 1;
  std::size_t checked_ = 0;
};

Result<LevelGrid> LevelGrid::build(const SurfaceDistance& surface, const LevelGridOptions& options,
                                   const Progress& progress) {
  LevelGrid grid;
  if (auto built = LevelGridBuilder(grid, surface, options, progress).build(); !built) {
    return tl::unexpected(built.error());
  }
  return grid;
}

Result<void> LevelGrid::split(const SurfaceDistance& surface, std::span<const Index> crossedCells,
                              std::span<const Index> quietCells, const LevelGridOptions& options,
                              const Progress& progress) {
  return LevelGridBuilder(*this, surface, options, progress).split(crossedCells, quietCells);
}

}  // namespace phront
