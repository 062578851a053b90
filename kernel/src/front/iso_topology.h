// Connectivity of an iso-surface on a LevelGrid: dual marching cubes without positions.
#pragma once

#include <array>
#include <vector>

#include "front/level_grid.h"
#include "phront/surface_distance.h"

namespace phront {

/// One vertex of the iso-surface: a cell and the crossed edges its patch of the surface runs over.
/// Edge 4a + u + 2v of a cell runs along axis a; u, v tell the upper side of axes a+1, a+2.
struct IsoSite {
  Index cell = kNone;
  std::uint16_t edges = 0;  ///< bit per edge of the cell
};

/// Polygons over sites; a closed manifold when every crossed edge has its four cells.
struct IsoTopology {
  std::vector<IsoSite> sites;
  std::vector<std::array<Index, 4>> quads;   ///< counter-clockwise seen from larger phi
  std::vector<std::vector<Index>> polygons;  ///< the few with five to eight sites; the first one
                                             ///< occurs in one other polygon only: fan from it
};

[[nodiscard]] IsoTopology isoTopology(const SurfaceDistance& surface, const LevelGrid& grid,
                                      int threads);

/// Corners at the lower and the upper end of an edge of a cell.
[[nodiscard]] std::array<int, 2> cornersOfEdge(int edge);

}  // namespace phront
