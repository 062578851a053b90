// The sweep is vector code for the instruction set that the machine has. godunov_tile_plain.cpp is
// the same source compiled once more without that choice, under another name.
#include "field/godunov_tile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "godunov_tile_plain.h"

namespace phront {
namespace {

template <class Real, int Dim>
struct RandomTiles {
  static constexpr std::size_t kNodes = Dim == 2 ? 64 : 512;
  std::array<std::array<Real, kNodes>, 2 * Dim + 1> values;  // the last is the tile
  std::array<Real, kNodes> steps;

  explicit RandomTiles(unsigned seed) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    for (auto& tile : values) {
      for (Real& value : tile)
        value = unit(rng) < 0.1 ? static_cast<Real>(4 * unit(rng)) : kFar<Real>;
    }
    for (Real& step : steps)
      step = unit(rng) < 0.1 ? kBlocked<Real> : static_cast<Real>(0.5 + unit(rng));
  }
  template <class View>
  View view(bool plainSteps) {
    View result;
    result.values = values.back().data();
    result.steps = plainSteps ? nullptr : steps.data();
    for (std::size_t side = 1; side < 2 * Dim; ++side)
      result.neighbours[side] = values[side].data();
    return result;  // side 0: none
  }
};

/// Nested loops over the nodes.
template <class Real, int Dim>
void loops(const TileView<Real, Dim>& tile, unsigned ordering) {
  const auto neighbour = [&](std::array<int, 3> place, std::size_t axis, int by) -> Real {
    place[axis] += by;
    const Real* values = tile.values;
    if (place[axis] < 0 || place[axis] > 7) values = tile.neighbours[2 * axis + (by > 0 ? 1 : 0)];
    place[axis] &= 7;
    return values == nullptr ? kFar<Real> : values[place[0] + 8 * place[1] + 64 * place[2]];
  };
  for (int n = 0; n < (Dim == 2 ? 64 : 512); ++n) {
    std::array<int, 3> place{n & 7, n >> 3 & 7, n >> 6};
    for (std::size_t axis = 0; axis < Dim; ++axis) {
      if ((ordering >> axis & 1U) != 0) place[axis] = 7 - place[axis];
    }
    const int at = place[0] + 8 * place[1] + 64 * place[2];
    const double step = tile.steps == nullptr ? 1 : tile.steps[at];
    std::array<double, Dim> a;
    for (std::size_t axis = 0; axis < Dim; ++axis)
      a[axis] = std::min(neighbour(place, axis, -1), neighbour(place, axis, 1));
    std::sort(a.begin(), a.end());
    double u = a[0] + step;
    double sum = a[0];
    double squares = a[0] * a[0];
    for (std::size_t used = 1; used < Dim && u > a[used]; ++used) {
      sum += a[used];
      squares += a[used] * a[used];
      const double count = static_cast<double>(used + 1);
      u = (sum + std::sqrt(sum * sum - count * (squares - step * step))) / count;
    }
    tile.values[at] = std::min(tile.values[at], static_cast<Real>(u));
  }
}

template <class Real, int Dim>
void compare(double tolerance) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (unsigned ordering = 0; ordering < (1U << Dim); ++ordering) {
      const bool plainSteps = seed % 2 == 0;
      RandomTiles<Real, Dim> ours(seed);
      RandomTiles<Real, Dim> plain(seed);
      RandomTiles<Real, Dim> looped(seed);
      const bool moved =
          sweepTile(ours.template view<TileView<Real, Dim>>(plainSteps), ordering, Real(0));
      const auto view = plain.template view<TileView<Real, Dim>>(plainSteps);
      EXPECT_EQ(moved,
                phront_plain::sweepTilePlain(view.values, view.steps, view.neighbours, ordering));
      EXPECT_EQ(ours.values, plain.values) << "seed " << seed << " ordering " << ordering;
      loops(looped.template view<TileView<Real, Dim>>(plainSteps), ordering);
      for (std::size_t n = 0; n < ours.values.back().size(); ++n) {
        const double expected = looped.values.back()[n];
        EXPECT_NEAR(ours.values.back()[n], expected, tolerance * (1 + expected));
      }
    }
  }
}

TEST(GodunovTile, SameBitsOnEveryInstructionSetAndTheLoopsOrder) {
  compare<float, 2>(2e-6);
  compare<float, 3>(2e-6);
  compare<double, 2>(1e-14);
  compare<double, 3>(1e-14);
}

}  // namespace
}  // namespace phront
