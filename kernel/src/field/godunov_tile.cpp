// Nodes on a diagonal plane p + q + r = L (p, q, r counted in sweeping direction) depend on the
// planes L - 1 (already swept) and L + 1 (not yet) only, so a plane is one vector operation
// (Detrixhe, Gibou, Min 2013, use it between threads). The tile is copied into scratch where planes
// are rows: node (p,q,r) lies in row (L, r) at q, and all six neighbours of a row are rows of the
// planes L - 1 and L + 1 at the same or the next place: contiguous loads, no gather. Lanes outside
// the tile hold kFar and a blocked step and stay that way.
//
// The compiler vectorises the row of 8; GCC makes one version for each instruction set and picks at
// run time. All versions give the same bits: no contraction, sqrt and division are exact in each.
#include "field/godunov_tile.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define PHRONT_CLONES __attribute__((target_clones("default", "avx2", "arch=x86-64-v4")))
#else
#define PHRONT_CLONES
#endif

namespace phront {
namespace {

constexpr int kSize = 8;
constexpr int kRow = kSize + 2;  // a lane of halo on both sides

/// Rows of all planes, with one plane and one row of halo around.
template <int Dim>
struct Scratch {
  static constexpr int kPlanes = Dim * (kSize - 1) + 1;
  static constexpr int kRows = Dim == 2 ? 1 : kSize;
  static constexpr int kHaloRows = Dim == 2 ? 1 : kSize + 2;
  using Planes = std::array<std::array<std::array<double, kRow>, kHaloRows>, kPlanes + 2>;

  /// Place of a node in sweeping direction, -1 .. 8 each.
  static double& at(Planes& planes, std::ptrdiff_t p, std::ptrdiff_t q, std::ptrdiff_t r) {
    return planes[static_cast<std::size_t>(p + q + r + 1)]
                 [Dim == 2 ? 0 : static_cast<std::size_t>(r + 1)][static_cast<std::size_t>(q + 1)];
  }

  Scratch() {
    for (auto& plane : value) {
      for (auto& row : plane) row.fill(kFar);
    }
    for (auto& plane : step) {
      for (auto& row : plane) row.fill(kBlocked);
    }
  }
  alignas(64) Planes value;
  alignas(64) Planes step;
};

PHRONT_CLONES
void sweepPlanes(Scratch<2>& s) {
  for (std::size_t plane = 1; plane <= Scratch<2>::kPlanes; ++plane) {
    const double* before = s.value[plane - 1][0].data();
    const double* after = s.value[plane + 1][0].data();
    double* here = s.value[plane][0].data();
    const double* step = s.step[plane][0].data();
    double updated[kSize];
    for (int q = 0; q < kSize; ++q) {
      const double a = before[q + 1] < after[q + 1] ? before[q + 1] : after[q + 1];
      const double b = before[q] < after[q + 2] ? before[q] : after[q + 2];
      const double next = godunovCandidate(a, b, step[q + 1]);
      updated[q] = next < here[q + 1] ? next : here[q + 1];
    }
    for (int q = 0; q < kSize; ++q) here[q + 1] = updated[q];
  }
}

PHRONT_CLONES
void sweepPlanes(Scratch<3>& s) {
  constexpr int kLast = kSize - 1;
  for (int level = 0; level < Scratch<3>::kPlanes; ++level) {
    const auto plane = static_cast<std::size_t>(level + 1);
    // Rows with a node of this plane.
    const int from = std::max(0, level - 2 * kLast);
    const int to = std::min(kLast, level);
    for (int r = from; r <= to; ++r) {
      const auto row = static_cast<std::size_t>(r + 1);
      const double* before = s.value[plane - 1][row].data();
      const double* after = s.value[plane + 1][row].data();
      const double* below = s.value[plane - 1][row - 1].data();
      const double* above = s.value[plane + 1][row + 1].data();
      double* here = s.value[plane][row].data();
      const double* step = s.step[plane][row].data();
      double updated[kSize];
      for (int q = 0; q < kSize; ++q) {
        const double a = before[q + 1] < after[q + 1] ? before[q + 1] : after[q + 1];
        const double b = before[q] < after[q + 2] ? before[q] : after[q + 2];
        const double c = below[q + 1] < above[q + 1] ? below[q + 1] : above[q + 1];
        const double next = godunovCandidate(a, b, c, step[q + 1]);
        updated[q] = next < here[q + 1] ? next : here[q + 1];
      }
      for (int q = 0; q < kSize; ++q) here[q + 1] = updated[q];
    }
  }
}

/// How (p, q, r) in sweeping direction walk over a tile with x fastest.
template <int Dim>
struct Walk {
  std::ptrdiff_t start = 0;
  std::array<std::ptrdiff_t, 3> stride{};  // the third is 0 in the plane

  explicit Walk(unsigned ordering) {
    std::ptrdiff_t size = 1;
    for (std::size_t axis = 0; axis < Dim; ++axis, size *= kSize) {
      const bool descending = (ordering >> axis & 1U) != 0;
      stride[axis] = descending ? -size : size;
      if (descending) start += (kSize - 1) * size;
    }
  }

  [[nodiscard]] std::ptrdiff_t operator()(std::ptrdiff_t p, std::ptrdiff_t q,
                                          std::ptrdiff_t r) const {
    return start + p * stride[0] + q * stride[1] + r * stride[2];
  }
};

/// The faces of the neighbours that touch the tile.
template <int Dim>
void loadHalo(const TileView<Dim>& tile, unsigned ordering, const Walk<Dim>& walk,
              Scratch<Dim>& s) {
  constexpr std::ptrdiff_t kLast = kSize - 1;
  std::array<const double*, Dim> upwind{};
  std::array<const double*, Dim> downwind{};
  for (std::size_t axis = 0; axis < Dim; ++axis) {
    const std::size_t descending = ordering >> axis & 1U;
    upwind[axis] = tile.neighbours[2 * axis + descending];
    downwind[axis] = tile.neighbours[2 * axis + 1 - descending];
  }
  const auto of = [](const double* values, std::ptrdiff_t n) {
    return values == nullptr ? kFar : values[n];
  };
  for (std::ptrdiff_t r = 0; r < Scratch<Dim>::kRows; ++r) {
    for (std::ptrdiff_t i = 0; i < kSize; ++i) {
      s.at(s.value, -1, i, r) = of(upwind[0], walk(kLast, i, r));
      s.at(s.value, kSize, i, r) = of(downwind[0], walk(0, i, r));
      s.at(s.value, i, -1, r) = of(upwind[1], walk(i, kLast, r));
      s.at(s.value, i, kSize, r) = of(downwind[1], walk(i, 0, r));
    }
  }
  if constexpr (Dim == 3) {
    for (std::ptrdiff_t q = 0; q < kSize; ++q) {
      for (std::ptrdiff_t p = 0; p < kSize; ++p) {
        s.at(s.value, p, q, -1) = of(upwind[2], walk(p, q, kLast));
        s.at(s.value, p, q, kSize) = of(downwind[2], walk(p, q, 0));
      }
    }
  }
}

}  // namespace

template <int Dim>
bool sweepTile(const TileView<Dim>& tile, unsigned ordering, double tolerance) {
  static thread_local Scratch<Dim> s;
  const Walk<Dim> walk(ordering);
  for (std::ptrdiff_t r = 0; r < Scratch<Dim>::kRows; ++r) {
    for (std::ptrdiff_t q = 0; q < kSize; ++q) {
      for (std::ptrdiff_t p = 0; p < kSize; ++p) {
        const std::ptrdiff_t n = walk(p, q, r);
        s.at(s.value, p, q, r) = tile.values[n];
        s.at(s.step, p, q, r) = tile.steps[n];
      }
    }
  }
  loadHalo(tile, ordering, walk, s);
  sweepPlanes(s);
  bool changed = false;
  for (std::ptrdiff_t r = 0; r < Scratch<Dim>::kRows; ++r) {
    for (std::ptrdiff_t q = 0; q < kSize; ++q) {
      for (std::ptrdiff_t p = 0; p < kSize; ++p) {
        double& value = tile.values[walk(p, q, r)];
        const double now = s.at(s.value, p, q, r);
        changed |= value - now > tolerance;
        value = now;
      }
    }
  }
  return changed;
}

template bool sweepTile<2>(const TileView<2>&, unsigned, double);
template bool sweepTile<3>(const TileView<3>&, unsigned, double);

}  // namespace phront
