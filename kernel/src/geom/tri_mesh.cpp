// Measures, diagnosis and welding of labelled triangle meshes. All serial and in index order, so
// sums have the same bits everywhere.
#include "phront/tri_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "geom/mesh_topology.h"

namespace phront {

namespace {

const Vec3& corner(const TriMesh& mesh, std::size_t t, std::size_t k) {
  return mesh.points[static_cast<std::size_t>(mesh.triangles[t][k])];
}

bool inRange(const TriMesh& mesh, std::size_t t) {
  const auto count = static_cast<Index>(mesh.points.size());
  return std::all_of(mesh.triangles[t].begin(), mesh.triangles[t].end(),
                     [count](Index i) { return i >= 0 && i < count; });
}

bool repeatsPoint(const std::array<Index, 3>& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

// Bits of a point, with -0 read as 0.
struct PointKey {
  std::array<std::uint64_t, 3> bits;
  explicit PointKey(const Vec3& p) {
    for (int i = 0; i < 3; ++i) {
      bits[static_cast<std::size_t>(i)] = std::bit_cast<std::uint64_t>(p[i] + 0.0);
    }
  }
  bool operator==(const PointKey&) const = default;
};
struct PointKeyHash {
  std::size_t operator()(const PointKey& key) const {
    std::uint64_t h = 0;
    for (const std::uint64_t b : key.bits) {
      h = (h ^ b) * 0x9E3779B97F4A7C15ULL;  // 2^64 / golden ratio: spreads the low mantissa bits
      h ^= h >> 29;
    }
    return h;
  }
};

}  // namespace

Box3 boundingBox(const TriMesh& mesh) {
  Box3 box;
  for (const Vec3& p : mesh.points) box.extend(p);
  return box;
}

double signedVolume(const TriMesh& mesh) {
  if (mesh.points.empty()) return 0;
  const Vec3 centre = boundingBox(mesh).center();  // keeps the terms small far from the origin
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 a = corner(mesh, t, 0) - centre;
    const Vec3 b = corner(mesh, t, 1) - centre;
    const Vec3 c = corner(mesh, t, 2) - centre;
    sum += a.dot(b.cross(c));
  }
  return sum / 6;
}

double area(const TriMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3& a = corner(mesh, t, 0);
    sum += (corner(mesh, t, 1) - a).cross(corner(mesh, t, 2) - a).norm();
  }
  return sum / 2;
}

MeshDiagnostics diagnose(const TriMesh& mesh) {
  MeshDiagnostics d;
  for (const Vec3& p : mesh.points) d.nonFinitePoints += p.allFinite() ? 0 : 1;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!inRange(mesh, t)) {
      ++d.badIndices;
      continue;
    }
    const Vec3& a = corner(mesh, t, 0);
    const bool flat = (corner(mesh, t, 1) - a).cross(corner(mesh, t, 2) - a).squaredNorm() == 0;
    if (repeatsPoint(mesh.triangles[t]) || flat) ++d.degenerateTriangles;
  }
  const MeshEdges edges = meshEdges(mesh);
  for (const MeshEdge& edge : edges.edges) {
    if (edge.count == 1) ++d.freeEdges;
    if (edge.count > 2) ++d.nonManifoldEdges;
    Index forward = 0;
    for (const Index side : edges.sidesOf(edge)) {
      forward += sideStart(mesh, side) == edge.low ? 1 : 0;
    }
    // A non-manifold edge may be run several times each way; it must be so equally often.
    if (edge.count > 1 && 2 * forward != edge.count) ++d.misorientedEdges;
  }
  const std::vector<bool> split = splitPoints(mesh, edges);
  d.nonManifoldPoints = static_cast<Index>(std::count(split.begin(), split.end(), true));
  d.components = connectedComponents(mesh).count;
  return d;
}

Components connectedComponents(const TriMesh& mesh) {
  DisjointSets sets(mesh.triangles.size());
  const MeshEdges edges = meshEdges(mesh);
  for (const MeshEdge& edge : edges.edges) {
    const auto sides = edges.sidesOf(edge);
    for (const Index side : sides.subspan(1)) sets.unite(sides[0] / 3, side / 3);
  }
  Components result;
  result.ofTriangle.resize(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Index root = sets.find(static_cast<Index>(t));  // smallest member: numbered already
    result.ofTriangle[t] = root == static_cast<Index>(t)
                               ? result.count++
                               : result.ofTriangle[static_cast<std::size_t>(root)];
  }
  return result;
}

TriMesh weld(const TriMesh& mesh) {
  TriMesh result;
  std::unordered_map<PointKey, Index, PointKeyHash> known;
  known.reserve(mesh.points.size());
  auto welded = [&](Index i) {
    const auto from = static_cast<std::size_t>(i);
    const Vec3& p = mesh.points[from];
    const auto [at, isNew] = known.try_emplace(PointKey(p), static_cast<Index>(known.size()));
    if (isNew) {
      result.points.push_back(p);
      if (!mesh.vertexOf.empty()) result.vertexOf.push_back(mesh.vertexOf[from]);
    } else if (!mesh.vertexOf.empty()) {
      Index& label = result.vertexOf[static_cast<std::size_t>(at->second)];
      if (label == kNone) label = mesh.vertexOf[from];
    }
    return at->second;
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!inRange(mesh, t)) continue;  // names no point: nothing to weld
    std::array<PointKey, 3> keys{PointKey(corner(mesh, t, 0)), PointKey(corner(mesh, t, 1)),
                                 PointKey(corner(mesh, t, 2))};
    if (keys[0] == keys[1] || keys[1] == keys[2] || keys[2] == keys[0]) continue;
    const auto& from = mesh.triangles[t];
    const Index a = welded(from[0]);
    const Index b = welded(from[1]);
    const Index c = welded(from[2]);
    result.triangles.push_back({a, b, c});
    if (!mesh.faceOf.empty()) result.faceOf.push_back(mesh.faceOf[t]);
    if (!mesh.edgeOf.empty()) {
      for (std::size_t k = 0; k < 3; ++k) result.edgeOf.push_back(mesh.edgeOf[3 * t + k]);
    }
  }
  return result;
}

}  // namespace phront
