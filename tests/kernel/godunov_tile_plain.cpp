// Everything of the kernel gets another name, so that both versions can be in one program.
#define PHRONT_ONE_CLONE
#define phront phront_plain
#include "field/godunov_tile.cpp"
#undef phront

#include "godunov_tile_plain.h"

namespace phront_plain {

#define PHRONT_PLAIN_TILE(Real, Dim)                                                      \
  bool sweepTilePlain(Real* values, const Real* steps,                                    \
                      std::array<const Real*, 2 * (Dim)> neighbours, unsigned ordering) { \
    return sweepTile(TileView<Real, Dim>{values, steps, neighbours}, ordering, Real(0));  \
  }
PHRONT_PLAIN_TILE(float, 2)
PHRONT_PLAIN_TILE(float, 3)
PHRONT_PLAIN_TILE(double, 2)
PHRONT_PLAIN_TILE(double, 3)

}  // namespace phront_plain
