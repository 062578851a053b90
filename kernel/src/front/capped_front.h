// An open part of a front as a closed mesh.
#pragma once

#include <vector>

#include "phront/iso_surface.h"

namespace phront::facet {

/// Over each border loop lies, from the other side, a fan of triangles with an apex of its own: so
/// that every stage sees a closed manifold.
struct CappedFront {
  IsoSurface iso;  ///< points: apexes, then those that stay in place, then the others
  Index apexes = 0;
  Index fixedPoints = 0;  ///< apexes and points of the borders
};

/// The fan of an apex over a loop that has the front on its left.
void addFan(TriMesh& mesh, const std::vector<Index>& loop, Index apex);

[[nodiscard]] Vec3 middleOf(const std::vector<Vec3>& points);

}  // namespace phront::facet
