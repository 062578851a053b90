// One Gauss-Seidel sweep of the Godunov upwind scheme over one tile.
#pragma once

#include <array>

namespace phront {

/// No value yet; far above any arrival time (in units of the spacing), and its square is finite.
template <class Real>
inline constexpr Real kFar = sizeof(Real) == sizeof(float) ? Real(1e15) : Real(1e100);
/// Step (1 / speed) of nodes that never change: no candidate from it is below kFar.
template <class Real>
inline constexpr Real kBlocked = 4 * kFar<Real>;

/// What a sweep sees: a tile of 8 nodes a side (x fastest) and the faces next to it. Times are in
/// units of the spacing.
template <class Real, int Dim>
struct TileView {
  Real* values = nullptr;       ///< 8^Dim
  const Real* steps = nullptr;  ///< 1 / speed per node, kBlocked: stays; null: 1 at every node
  /// Values of the neighbouring tiles, [2 * axis + side], null where there is none: one-sided.
  std::array<const Real*, 2 * Dim> neighbours{};
};

/// Lowers the values by the first-order Godunov scheme, nodes in the order `ordering`: bit `axis`
/// set means descending along it. The order is that of nested loops; the bits are the same on every
/// processor. Returns whether a value fell by more than `tolerance`.
template <class Real, int Dim>
bool sweepTile(const TileView<Real, Dim>& tile, unsigned ordering, Real tolerance);

}  // namespace phront
