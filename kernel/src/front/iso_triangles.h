// Triangles of an iso-surface: diagonals of quads, folds, short edges, labels.
#pragma once

#include <array>
#include <vector>

#include "front/iso_topology.h"
#include "front/iso_vertex.h"

namespace phront {

using Triangle = std::array<Index, 3>;

/// Splits quads along the diagonal that lies closer to phi = level, polygons as fans.
[[nodiscard]] std::vector<Triangle> splitPolygons(const SurfaceDistance& surface,
                                                  const IsoTopology& topology,
                                                  const std::vector<IsoVertex>& vertices,
                                                  double level, int threads);

/// Numbers of the vertices of triangles that look against the gradient of phi; sorted.
[[nodiscard]] std::vector<Index> foldedVertices(const SurfaceDistance& surface,
                                                const std::vector<Triangle>& triangles,
                                                const std::vector<IsoVertex>& vertices,
                                                int threads);

}  // namespace phront
