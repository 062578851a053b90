#include "field/godunov_tile.h"

#include <algorithm>
#include <cstddef>

#include "base/lanes.h"
#include "field/skewed_tile.h"

namespace phront {
namespace {

/// Sweeps N lanes of a row. `Upwind` is 1 when lanes ascend in sweeping direction, else -1.
///
/// The candidate is the larger root of sum max(0, u - a_i)^2 = step^2 for the smaller neighbours
/// a_i along the axes (Rouy and Tourin 1992), without branches and with one square root: of the
/// sorted values low, low + g, low + k the second is cut to low + step, where it adds nothing; the
/// third takes part when k^2 + (k - g)^2 < step^2, and the discriminant of three axes is that of
/// two and what is missing there.
template <class Real, int Dim, int N, std::ptrdiff_t Upwind>
PHRONT_INLINE void sweepRow(Real* here, const Real* steps) {
  using Tile = SkewedTile<Real, Dim>;
  using L = Lanes<Real, N>;
  const auto smaller = [](const Real* a, const Real* b) __attribute__((always_inline)) {
    return minOf<L>(loadLanes<L>(a), loadLanes<L>(b));
  };
  const L step = loadLanes<L>(steps);
  const L x = smaller(here - Tile::kRow - Upwind, here + Tile::kRow + Upwind);
  const L y = smaller(here - Tile::kRow, here + Tile::kRow);
  L candidate;
  if constexpr (Dim == 2) {
    const L low = minOf<L>(x, y);
    const L g = minOf<L>(maxOf<L>(x, y) - low, step);
    const L root = sqrtOf<Real, N>(step * step + step * step - g * g);
    candidate = low + (g + root) * Real(0.5);
  } else {
    const L z = smaller(here - Tile::kSlice, here + Tile::kSlice);
    const L xy = minOf<L>(x, y);
    const L yx = maxOf<L>(x, y);
    const L low = minOf<L>(xy, z);
    const L rest = maxOf<L>(xy, z);
    const L g = minOf<L>(minOf<L>(yx, rest) - low, step);
    const L k = maxOf<L>(yx, rest) - low;
    const L squared = step * step;
    const L missing = squared - (k * k + (k - g) * (k - g));
    const L none{};
    const auto third = missing > none;
    const L root = sqrtOf<Real, N>((squared + squared - g * g) + (third ? missing : none));
    const L half = none + Real(0.5);
    const L inThree = none + Real(1.0 / 3.0);
    candidate = low + (g + (third ? k : none) + root) * (third ? inThree : half);
  }
  storeLanes(here, minOf<L>(candidate, loadLanes<L>(here)));
}

/// All rows in the order of the diagonal planes. The first and the last rows of a slice fill only
/// half of the lanes.
template <class Real, int Dim, bool Descending>
PHRONT_INLINE void sweepRows(SkewedTile<Real, Dim>& tile) {
  using Tile = SkewedTile<Real, Dim>;
  constexpr int kLastRow = 2 * (Tile::kSize - 1);
  constexpr int kSlices = Tile::kSlices;
  constexpr std::ptrdiff_t kUpwind = Descending ? -1 : 1;
  constexpr std::ptrdiff_t kEarly = Descending ? Tile::kHalf : 0;
  constexpr std::ptrdiff_t kLate = Tile::kHalf - kEarly;
  for (int plane = 0; plane < kLastRow + kSlices; ++plane) {
    for (int slice = std::max(0, plane - kLastRow); slice < std::min(kSlices, plane + 1); ++slice) {
      const int row = plane - slice;
      Real* here = tile.values.data() + Tile::at(row, slice);
      const Real* steps = tile.steps.data() + Tile::at(row, slice);
      if (row < Tile::kHalf) {
        sweepRow<Real, Dim, 4, kUpwind>(here + kEarly, steps + kEarly);
      } else if (row > kLastRow - Tile::kHalf) {
        sweepRow<Real, Dim, 4, kUpwind>(here + kLate, steps + kLate);
      } else if constexpr (sizeof(Real) == sizeof(float)) {
        sweepRow<Real, Dim, 8, kUpwind>(here, steps);
      } else {
        sweepRow<Real, Dim, 4, kUpwind>(here, steps);
        sweepRow<Real, Dim, 4, kUpwind>(here + 4, steps + 4);
      }
    }
  }
}

/// Where the nodes of a tile lie in memory, by their place in sweeping direction.
template <int Dim>
struct Walk {
  unsigned ordering;

  [[nodiscard]] bool descending(unsigned axis) const { return (ordering >> axis & 1U) != 0; }
  [[nodiscard]] std::ptrdiff_t place(unsigned axis, std::ptrdiff_t n) const {
    return descending(axis) ? 7 - n : n;
  }
  /// First node of row q of slice r.
  [[nodiscard]] std::ptrdiff_t row(std::ptrdiff_t q, std::ptrdiff_t r) const {
    return 8 * place(1, q) + (Dim == 2 ? 0 : 64 * place(2, r));
  }
};

/// One sweep of one tile; a class, as its parts must be inlined into each clone.
template <class Real, int Dim, bool Descending>
class TileSweep {
 public:
  using Tile = SkewedTile<Real, Dim>;

  PHRONT_INLINE static bool run(const TileView<Real, Dim>& view, unsigned ordering, Real tolerance,
                                Tile& tile, bool& plainSteps) {
    const Walk<Dim> walk{ordering};
    load(view, walk, tile);
    if (view.steps != nullptr || !plainSteps) loadSteps(view.steps, walk, tile);
    plainSteps = view.steps == nullptr;
    sweepRows<Real, Dim, Descending>(tile);
    return store(view, walk, tile, tolerance);
  }

 private:
  static constexpr std::ptrdiff_t kRow = Tile::kRow;

  /// Both halves of the rows; `skewed` is the row of the first one's first node.
  template <int Count>
  PHRONT_INLINE static void skew(const MemoryRows<Real, Count>& rows, Real fill, Real* skewed) {
    constexpr std::ptrdiff_t kLow = Descending ? 4 * kRow : 0;  // lanes 0 .. 3 come later then
    constexpr std::ptrdiff_t kHigh = 4 * kRow - kLow;
    skewHalf<Real, Count, Descending, kRow>(rows, 0, fill, skewed + kLow);
    skewHalf<Real, Count, Descending, kRow>(rows, 4, fill, skewed + kHigh + 4);
  }

  PHRONT_INLINE static void load(const TileView<Real, Dim>& view, const Walk<Dim>& walk,
                                 Tile& tile) {
    static const auto kNone = [] {
      std::array<Real, 512> none;
      none.fill(kFar<Real>);
      return none;
    }();
    const auto neighbour = [&](unsigned axis, bool downwind) {
      const Real* values =
          view.neighbours[2 * axis + static_cast<std::size_t>(walk.descending(axis) != downwind)];
      return values == nullptr ? kNone.data() : values;
    };
    const Real* left = neighbour(0, false) + walk.place(0, 7);
    const Real* right = neighbour(0, true) + walk.place(0, 0);
    const Real* front = neighbour(1, false);
    const Real* back = neighbour(1, true);
    constexpr std::ptrdiff_t kBefore = Descending ? 8 : -1;
    constexpr std::ptrdiff_t kAfter = Descending ? -1 : 8;
    for (std::ptrdiff_t r = 0; r < Tile::kSlices; ++r) {
      MemoryRows<Real, 10> rows;
      rows.front() = front + walk.row(7, r);
      for (std::ptrdiff_t q = 0; q < 8; ++q)
        rows[static_cast<std::size_t>(q + 1)] = view.values + walk.row(q, r);
      rows.back() = back + walk.row(0, r);
      Real* slice = tile.values.data() + Tile::at(-1, r);
      skew<10>(rows, kFar<Real>, slice);
      for (std::ptrdiff_t q = 0; q < 8; ++q) {
        slice[q * kRow + kBefore] = left[walk.row(q, r)];
        slice[(q + 9) * kRow + kAfter] = right[walk.row(q, r)];
      }
    }
    if constexpr (Dim == 3) {
      loadSlice(neighbour(2, false), walk, 7, tile.values.data() + Tile::at(0, -1));
      loadSlice(neighbour(2, true), walk, 0, tile.values.data() + Tile::at(0, 8));
    }
  }

  PHRONT_INLINE static void loadSlice(const Real* values, const Walk<Dim>& walk, std::ptrdiff_t r,
                                      Real* skewed) {
    MemoryRows<Real, 8> rows;
    for (std::ptrdiff_t q = 0; q < 8; ++q)
      rows[static_cast<std::size_t>(q)] = values + walk.row(q, r);
    skew<8>(rows, kFar<Real>, skewed);
  }

  PHRONT_INLINE static void loadSteps(const Real* steps, const Walk<Dim>& walk, Tile& tile) {
    static constexpr std::array<Real, 8> kPlain{1, 1, 1, 1, 1, 1, 1, 1};
    for (std::ptrdiff_t r = 0; r < Tile::kSlices; ++r) {
      MemoryRows<Real, 8> rows;
      for (std::ptrdiff_t q = 0; q < 8; ++q) {
        rows[static_cast<std::size_t>(q)] =
            steps == nullptr ? kPlain.data() : steps + walk.row(q, r);
      }
      skew<8>(rows, kBlocked<Real>, tile.steps.data() + Tile::at(0, r));
    }
  }

  PHRONT_INLINE static bool store(const TileView<Real, Dim>& view, const Walk<Dim>& walk,
                                  const Tile& tile, Real tolerance) {
    constexpr std::ptrdiff_t kLow = Descending ? 4 * kRow : 0;
    constexpr std::ptrdiff_t kHigh = 4 * kRow - kLow;
    Lanes<Real, 4> most{};
    for (std::ptrdiff_t r = 0; r < Tile::kSlices; ++r) {
      std::array<Real*, 8> rows;
      for (std::ptrdiff_t q = 0; q < 8; ++q)
        rows[static_cast<std::size_t>(q)] = view.values + walk.row(q, r);
      const Real* slice = tile.values.data() + Tile::at(0, r);
      most = maxOf(most, unskewHalf<Real, Descending, kRow>(slice + kLow, rows, 0));
      most = maxOf(most, unskewHalf<Real, Descending, kRow>(slice + kHigh + 4, rows, 4));
    }
    return std::max(std::max(most[0], most[1]), std::max(most[2], most[3])) > tolerance;
  }
};

// Clones cannot be templates.
template <class Real, int Dim>
struct Kept {
  SkewedTile<Real, Dim> tile;
  bool plainSteps = false;  ///< the steps of the tile are those of speed 1
};

#define PHRONT_SWEEP(Real, Dim, Descending, name)                                             \
  PHRONT_CLONES bool name(const TileView<Real, Dim>& view, unsigned ordering, Real tolerance, \
                          Kept<Real, Dim>& kept) {                                            \
    return TileSweep<Real, Dim, Descending>::run(view, ordering, tolerance, kept.tile,        \
                                                 kept.plainSteps);                            \
  }
PHRONT_SWEEP(float, 2, false, sweepAscending)
PHRONT_SWEEP(float, 3, false, sweepAscending)
PHRONT_SWEEP(double, 2, false, sweepAscending)
PHRONT_SWEEP(double, 3, false, sweepAscending)
PHRONT_SWEEP(float, 2, true, sweepDescending)
PHRONT_SWEEP(float, 3, true, sweepDescending)
PHRONT_SWEEP(double, 2, true, sweepDescending)
PHRONT_SWEEP(double, 3, true, sweepDescending)

}  // namespace

template <class Real, int Dim>
bool sweepTile(const TileView<Real, Dim>& tile, unsigned ordering, Real tolerance) {
  static thread_local Kept<Real, Dim> ascending;
  static thread_local Kept<Real, Dim> descending;
  return (ordering & 1U) == 0 ? sweepAscending(tile, ordering, tolerance, ascending)
                              : sweepDescending(tile, ordering, tolerance, descending);
}

template bool sweepTile<float, 2>(const TileView<float, 2>&, unsigned, float);
template bool sweepTile<float, 3>(const TileView<float, 3>&, unsigned, float);
template bool sweepTile<double, 2>(const TileView<double, 2>&, unsigned, double);
template bool sweepTile<double, 3>(const TileView<double, 3>&, unsigned, double);

}  // namespace phront
