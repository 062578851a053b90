// Neighbourhoods of a triangle mesh: what lies across a side, which triangles meet in a point.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "phront/tri_mesh.h"

namespace phront {

/// Undirected edge with every side that runs along it. A side is 3 * triangle + k and leads from
/// corner k to corner k + 1.
struct MeshEdge {
  Index low = kNone;   ///< smaller point index
  Index high = kNone;  ///< larger point index
  Index first = 0;     ///< range into MeshEdges::sides
  Index count = 0;
};

struct MeshEdges {
  std::vector<MeshEdge> edges;  ///< sorted by (low, high)
  std::vector<Index> sides;     ///< grouped by edge, ascending within each

  [[nodiscard]] std::span<const Index> sidesOf(const MeshEdge& edge) const {
    return {sides.data() + edge.first, static_cast<std::size_t>(edge.count)};
  }
};

/// Edges of all triangles whose indices are in range; sides of zero index length are left out.
[[nodiscard]] MeshEdges meshEdges(const TriMesh& mesh);

[[nodiscard]] inline Index sideStart(const TriMesh& mesh, Index side) {
  return mesh.triangles[static_cast<std::size_t>(side / 3)][static_cast<std::size_t>(side % 3)];
}
[[nodiscard]] inline Index sideEnd(const TriMesh& mesh, Index side) {
  return mesh
      .triangles[static_cast<std::size_t>(side / 3)][static_cast<std::size_t>((side % 3 + 1) % 3)];
}

/// Union-find with path halving; roots are the smallest member.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count);
  [[nodiscard]] Index find(Index i);
  void unite(Index a, Index b);

 private:
  std::vector<Index> parent_;
};

/// Triangles around each point (compressed rows, ascending ids).
struct PointRings {
  std::vector<Index> first;      ///< n + 1
  std::vector<Index> triangles;  ///< 3m

  [[nodiscard]] std::span<const Index> of(Index point) const {
    const auto p = static_cast<std::size_t>(point);
    return {triangles.data() + first[p], static_cast<std::size_t>(first[p + 1] - first[p])};
  }
};
/// All indices must be in range.
[[nodiscard]] PointRings pointRings(const TriMesh& mesh);

/// True for points whose triangles form more than one fan around edges.
[[nodiscard]] std::vector<bool> splitPoints(const TriMesh& mesh, const MeshEdges& edges);

}  // namespace phront
