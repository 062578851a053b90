// Connectivity of an iso-surface on a LevelGrid: dual marching cubes without positions.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "front/level_grid.h"
#include "phront/surface_distance.h"

namespace phront {

/// Nodes at the ends of a crossed shortest edge, the lower one first.
using Crossing = std::array<Index, 2>;

/// One vertex of the iso-surface: a cell and the crossings that its patch of the surface runs over.
struct IsoSite {
  Index cell = kNone;
  Index first = 0;  ///< into IsoTopology::crossings
  Index count = 0;
  bool alone = false;  ///< the cell has no other site
};

/// Polygons over sites; a closed manifold when every crossed edge has its cells.
struct IsoTopology {
  std::vector<IsoSite> sites;
  std::vector<Crossing> crossings;
  std::vector<std::array<Index, 4>> quads;   ///< counter-clockwise seen from larger phi
  std::vector<std::vector<Index>> polygons;  ///< the few with three or five to eight sites; of the
                                             ///< latter the first one occurs in one other polygon
                                             ///< only: fan from it

  [[nodiscard]] std::span<const Crossing> crossingsOf(const IsoSite& site) const {
    return std::span(crossings).subspan(static_cast<std::size_t>(site.first),
                                        static_cast<std::size_t>(site.count));
  }
};

[[nodiscard]] IsoTopology isoTopology(const SurfaceDistance& surface, const LevelGrid& grid,
                                      int threads);

}  // namespace phront
