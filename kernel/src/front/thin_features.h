// Parts of {phi < d}, or gaps in it, that pass between the nodes of a grid.
#pragma once

#include "front/level_grid.h"
#include "phront/surface_distance.h"
#include "phront/tri_mesh.h"

namespace phront {

/// True when a cell whose corners agree in sign holds a point of the other sign, at least `depth`
/// deep, that `mesh` (the level as extracted from the grid) has on the wrong side.
[[nodiscard]] Result<bool> hidesThinFeature(const SurfaceDistance& surface, const LevelGrid& grid,
                                            const TriMesh& mesh, double depth, int threads);

}  // namespace phront
