#include "geom/mesh_topology.h"

#include <algorithm>
#include <numeric>

namespace phront {

namespace {

bool inRange(const TriMesh& mesh, const std::array<Index, 3>& triangle) {
  const auto count = static_cast<Index>(mesh.points.size());
  return std::all_of(triangle.begin(), triangle.end(),
                     [count](Index i) { return i >= 0 && i < count; });
}

struct SideKey {
  Index low, high, side;
  bool operator<(const SideKey& o) const {
    if (low != o.low) return low < o.low;
    if (high != o.high) return high < o.high;
    return side < o.side;
  }
};

}  // namespace

MeshEdges meshEdges(const TriMesh& mesh) {
  std::vector<SideKey> keys;
  keys.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!inRange(mesh, mesh.triangles[t])) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto side = static_cast<Index>(3 * t + k);
      const Index a = sideStart(mesh, side);
      const Index b = sideEnd(mesh, side);
      if (a != b) keys.push_back({std::min(a, b), std::max(a, b), side});
    }
  }
  std::sort(keys.begin(), keys.end());

  MeshEdges result;
  result.sides.reserve(keys.size());
  for (const SideKey& key : keys) {
    if (result.edges.empty() || result.edges.back().low != key.low ||
        result.edges.back().high != key.high) {
      result.edges.push_back({key.low, key.high, static_cast<Index>(result.sides.size()), 0});
    }
    result.sides.push_back(key.side);
    ++result.edges.back().count;
  }
  return result;
}

DisjointSets::DisjointSets(std::size_t count) : parent_(count) {
  std::iota(parent_.begin(), parent_.end(), 0);
}

Index DisjointSets::find(Index i) {
  auto up = [this](Index j) -> Index& { return parent_[static_cast<std::size_t>(j)]; };
  while (up(i) != i) {
    up(i) = up(up(i));
    i = up(i);
  }
  return i;
}

void DisjointSets::unite(Index a, Index b) {
  a = find(a);
  b = find(b);
  parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
}

PointRings pointRings(const TriMesh& mesh) {
  PointRings rings;
  rings.first.assign(mesh.points.size() + 1, 0);
  for (const auto& triangle : mesh.triangles) {
    for (const Index p : triangle) ++rings.first[static_cast<std::size_t>(p) + 1];
  }
  std::partial_sum(rings.first.begin(), rings.first.end(), rings.first.begin());
  rings.triangles.resize(3 * mesh.triangles.size());
  std::vector<Index> next(rings.first.begin(), rings.first.end() - 1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const Index p : mesh.triangles[t]) {
      rings.triangles[static_cast<std::size_t>(next[static_cast<std::size_t>(p)]++)] =
          static_cast<Index>(t);
    }
  }
  return rings;
}

std::vector<bool> splitPoints(const TriMesh& mesh, const MeshEdges& edges) {
  // Corners (3t + k) of triangles that share an edge belong to one fan at both its ends.
  DisjointSets fans(3 * mesh.triangles.size());
  auto cornerAt = [&mesh](Index side, Index point) {
    return sideStart(mesh, side) == point ? side : side / 3 * 3 + (side % 3 + 1) % 3;
  };
  for (const MeshEdge& edge : edges.edges) {
    const auto sides = edges.sidesOf(edge);
    for (const Index side : sides.subspan(1)) {
      fans.unite(cornerAt(sides[0], edge.low), cornerAt(side, edge.low));
      fans.unite(cornerAt(sides[0], edge.high), cornerAt(side, edge.high));
    }
  }
  std::vector<Index> fanOf(mesh.points.size(), kNone);
  std::vector<bool> split(mesh.points.size(), false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& triangle = mesh.triangles[t];
    if (!inRange(mesh, triangle)) continue;
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) {
      continue;  // a collapsed triangle makes no fan of its own
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const auto p = static_cast<std::size_t>(triangle[k]);
      const Index root = fans.find(static_cast<Index>(3 * t + k));
      if (fanOf[p] == kNone) fanOf[p] = root;
      if (fanOf[p] != root) split[p] = true;
    }
  }
  return split;
}

}  // namespace phront
