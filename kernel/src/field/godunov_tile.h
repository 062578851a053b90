// One Gauss-Seidel sweep of the Godunov upwind scheme over one tile.
#pragma once

#include <array>
#include <cmath>

namespace phront {

/// No value yet; far above any arrival time, and its square is finite.
inline constexpr double kFar = 1e100;
/// Step (h / speed) of nodes that never change: no candidate from it is below kFar.
inline constexpr double kBlocked = 4e100;

/// Value at a node whose smaller neighbours along the axes are a, b: the larger root of
/// sum max(0, u - a_i)^2 = step^2 (Rouy and Tourin 1992). Without branches, for vector code.
inline double godunovCandidate(double a, double b, double step) {
  const double low = a < b ? a : b;
  const double high = a < b ? b : a;
  const double gap = high - low;
  const double under = 2 * step * step - gap * gap;
  const double both = 0.5 * (gap + std::sqrt(under > 0 ? under : 0));
  return low + (step > gap ? both : step);
}

inline double godunovCandidate(double a, double b, double c, double step) {
  const double ab = a < b ? a : b;
  const double ba = a < b ? b : a;
  const double low = ab < c ? ab : c;
  const double rest = ab < c ? c : ab;
  const double middle = ba < rest ? ba : rest;
  const double high = ba < rest ? rest : ba;
  const double g = middle - low;
  const double k = high - low;
  const double ss = step * step;
  const double underTwo = 2 * ss - g * g;
  const double two = 0.5 * (g + std::sqrt(underTwo > 0 ? underTwo : 0));
  const double sum = g + k;
  const double underThree = sum * sum - 3 * (g * g + k * k - ss);
  const double three = (sum + std::sqrt(underThree > 0 ? underThree : 0)) * (1.0 / 3.0);
  const double upToTwo = step > g ? two : step;
  return low + (upToTwo > k ? three : upToTwo);
}

/// What a sweep sees: a tile of 8 nodes a side (x fastest) and the faces next to it.
template <int Dim>
struct TileView {
  double* values = nullptr;       ///< 8^Dim
  const double* steps = nullptr;  ///< h / speed per node; kBlocked: keeps its value
  /// Values of the neighbouring tiles, [2 * axis + side], null where there is none: one-sided.
  std::array<const double*, 2 * Dim> neighbours{};
};

/// Lowers the values by the first-order Godunov scheme, nodes in the order `ordering`: bit `axis`
/// set means descending along it. The same bits as nested loops, on every processor. Returns
/// whether a value fell by more than `tolerance`.
template <int Dim>
bool sweepTile(const TileView<Dim>& tile, unsigned ordering, double tolerance);

extern template bool sweepTile<2>(const TileView<2>&, unsigned, double);
extern template bool sweepTile<3>(const TileView<3>&, unsigned, double);

}  // namespace phront
