// Triangles on their way from per-face triangulations to one closed mesh.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "tessellate/occt_mesh.h"

namespace phront::cad {

/// The piece of a B-Rep edge under one triangle side; smooth edges and seams included.
struct SideLabel {
  Index edge = kNone;
  double first = 0;  ///< curve parameter at corner k
  double last = 0;   ///< at corner k+1
};

struct SoupTriangle {
  std::array<Index, 3> corner{};
  Index face = kNone;
  std::array<Eigen::Vector2d, 3> uv{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(),
                                    Eigen::Vector2d::Zero()};
  std::array<SideLabel, 3> side{};
  Index patch = kNone;  ///< number of the hole it fills
};

struct Soup {
  std::vector<Vec3> points;
  std::vector<Index> vertexOf;  ///< per point, B-Rep vertex or kNone
  std::vector<SoupTriangle> triangles;
};

/// Merges the nodes of neighbouring faces: the k-th node along an edge is one point for all faces
/// of the edge, ends of edges are their vertices, degenerated edges are one point. Where faces cut
/// an edge into different numbers of pieces, nodes within `edgeTolerance` (per edge) of each other
/// are merged and the rest stays apart. Triangles that collapse are dropped.
[[nodiscard]] Soup mergeNodes(const ShapeMesh& mesh, const std::vector<double>& edgeTolerance,
                              Index vertexCount);

}  // namespace phront::cad
