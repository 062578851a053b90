// The sweep of the kernel compiled for the least instruction set.
#pragma once

#include <array>

namespace phront_plain {

/// sweepTile() with tolerance 0; 4 neighbours: in the plane, 6: in space.
bool sweepTilePlain(float* values, const float* steps, std::array<const float*, 4> neighbours,
                    unsigned ordering);
bool sweepTilePlain(float* values, const float* steps, std::array<const float*, 6> neighbours,
                    unsigned ordering);
bool sweepTilePlain(double* values, const double* steps, std::array<const double*, 4> neighbours,
                    unsigned ordering);
bool sweepTilePlain(double* values, const double* steps, std::array<const double*, 6> neighbours,
                    unsigned ordering);

}  // namespace phront_plain
