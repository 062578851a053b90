// Parts of {phi < d}, or gaps in it, that pass between the nodes of a grid.
#pragma once

#include <vector>

#include "front/level_grid.h"
#include "phront/surface_distance.h"
#include "phront/tri_mesh.h"

namespace phront {

/// A point of the sign that the corners of its cell do not have.
struct ThinFeature {
  Index quietCell = kNone;
  Vec3 point = Vec3::Zero();
};

/// One for each quiet cell that holds some at least `depth` deep: of all cells, or only of those
/// not searched before. The grid remembers what was found.
enum class SearchIn { AllCells, PendingCells };
[[nodiscard]] std::vector<ThinFeature> findThinFeatures(const SurfaceDistance& surface,
                                                        LevelGrid& grid, double depth, SearchIn in,
                                                        int threads);

/// Those that `mesh`, the level as extracted from the grid, has on the wrong side.
[[nodiscard]] Result<std::vector<ThinFeature>> missedFeatures(const SurfaceDistance& surface,
                                                              const LevelGrid& grid,
                                                              const TriMesh& mesh,
                                                              std::vector<ThinFeature> features,
                                                              int threads);

}  // namespace phront
