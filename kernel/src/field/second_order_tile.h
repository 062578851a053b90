// One Gauss-Seidel sweep of the second-order scheme over one tile.
#pragma once

#include "field/godunov_tile.h"

namespace phront {

/// Replaces the values by the upwind scheme with one-sided differences of second order, nodes in
/// the order `ordering` as in sweepTile(). `first` holds the solution of first order: it says which
/// nodes lie upwind. Returns whether a value changed by more than `tolerance`.
template <int Dim>
bool refineTile(const TileView<double, Dim>& tile, const TileView<double, Dim>& first,
                unsigned ordering, double tolerance);

extern template bool refineTile<2>(const TileView<double, 2>&, const TileView<double, 2>&, unsigned,
                                   double);
extern template bool refineTile<3>(const TileView<double, 3>&, const TileView<double, 3>&, unsigned,
                                   double);

}  // namespace phront
