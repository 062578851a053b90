// Where a crease runs from cell to cell so near a grid edge that the cells between hold no point of
// it, an edge of the mesh crosses it from face to face and cuts it off. Flipping such an edge joins
// the two crease vertices beside it (Kobbelt, Botsch, Schwanecke & Seidel 2001). The same operation
// removes triangles of no height between three vertices of one crease. A flip is done only if its
// new edge is not there yet (the surface stays a manifold), both new triangles look along grad phi,
// and phi at the middle of the new edge is nearer to the level.
#include "front/iso_flips.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "geom/mesh_topology.h"

namespace phront {

namespace {

constexpr int kPasses = 4;
// Height over longest side of a triangle without height.
constexpr double kFlat = 1e-4;

class Flipper {
 public:
  Flipper(const SurfaceDistance& surface, const std::vector<IsoVertex>& vertices, double level,
          std::vector<Triangle>& triangles)
      : surface_(surface), vertices_(vertices), level_(level), triangles_(triangles) {}

  bool pass() {
    TriMesh mesh;
    mesh.triangles = triangles_;
    mesh.points.resize(vertices_.size());
    const MeshEdges edges = meshEdges(mesh);
    touched_.assign(triangles_.size(), 0);
    added_.clear();
    bool any = false;
    for (const MeshEdge& edge : edges.edges) {
      const auto sides = edges.sidesOf(edge);
      if (sides.size() != 2) continue;
      any = tryFlip(edges, sides[0], sides[1]) || any;
    }
    return any;
  }

 private:
  [[nodiscard]] const IsoVertex& vertex(Index v) const {
    return vertices_[static_cast<std::size_t>(v)];
  }
  [[nodiscard]] Index corner(Index side, int step) const {
    return triangles_[static_cast<std::size_t>(side / 3)]
                     [static_cast<std::size_t>((side % 3 + step) % 3)];
  }

  [[nodiscard]] double middleError(Index a, Index b) const {
    const Vec3 middle = 0.5 * (vertex(a).point + vertex(b).point);
    return std::abs(surface_.footFrom(middle, vertex(a).foot.triangle).phi() - level_);
  }

  [[nodiscard]] Vec3 areaVector(const Triangle& t) const {
    return (vertex(t[1]).point - vertex(t[0]).point).cross(vertex(t[2]).point - vertex(t[0]).point);
  }

  /// No height over the side from a to b, c between them.
  [[nodiscard]] bool flat(Index a, Index b, Index c) const {
    const Vec3 side = vertex(b).point - vertex(a).point;
    const Vec3 other = vertex(c).point - vertex(a).point;
    const double along = side.dot(other) / side.squaredNorm();
    return along > 0 && along < 1 && side.cross(other).norm() < kFlat * side.squaredNorm();
  }

  [[nodiscard]] bool upright(const Triangle& t) const {
    const Vec3 area = areaVector(t);
    const Vec3 centroid = (vertex(t[0]).point + vertex(t[1]).point + vertex(t[2]).point) / 3;
    const FootPoint foot = surface_.footFrom(centroid, vertex(t[0]).foot.triangle);
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      longest =
          std::max(longest, (vertex(t[(k + 1) % 3]).point - vertex(t[k]).point).squaredNorm());
    }
    return area.dot(surface_.gradient(centroid, foot)) > kFlat * longest;
  }

  [[nodiscard]] bool joined(const MeshEdges& edges, Index a, Index b) const {
    const auto key = std::pair{std::min(a, b), std::max(a, b)};
    const auto low = [](const MeshEdge& e) { return std::pair{e.low, e.high}; };
    const auto found = std::ranges::lower_bound(edges.edges, key, {}, low);
    return (found != edges.edges.end() && low(*found) == key) || added_.contains(key);
  }

  bool tryFlip(const MeshEdges& edges, Index side0, Index side1) {
    const auto t0 = static_cast<std::size_t>(side0 / 3);
    const auto t1 = static_cast<std::size_t>(side1 / 3);
    if (touched_[t0] != 0 || touched_[t1] != 0) return false;
    const Index a = corner(side0, 0);
    const Index b = corner(side0, 1);
    const Index c = corner(side0, 2);
    const Index e = corner(side1, 2);
    if (corner(side1, 0) != b || c == e) return false;
    const bool ends = vertex(a).crease && vertex(b).crease;
    const bool noHeight = ends && (flat(a, b, c) || flat(a, b, e));
    if (!noHeight && (ends || !vertex(c).crease || !vertex(e).crease)) return false;
    if (joined(edges, c, e)) return false;
    if (!noHeight && !(middleError(c, e) < 0.5 * middleError(a, b))) return false;
    const Triangle first{a, e, c};
    const Triangle second{e, b, c};
    if (!upright(first) || !upright(second)) return false;
    triangles_[t0] = first;
    triangles_[t1] = second;
    touched_[t0] = touched_[t1] = 1;
    added_.emplace(std::min(c, e), std::max(c, e));
    return true;
  }

  const SurfaceDistance& surface_;
  const std::vector<IsoVertex>& vertices_;
  double level_;
  std::vector<Triangle>& triangles_;
  std::vector<char> touched_;
  std::set<std::pair<Index, Index>> added_;
};

}  // namespace

void flipToCreases(const SurfaceDistance& surface, const std::vector<IsoVertex>& vertices,
                   double level, std::vector<Triangle>& triangles) {
  if (std::ranges::none_of(vertices, [](const IsoVertex& v) { return v.crease; })) return;
  Flipper flipper(surface, vertices, level, triangles);
  for (int pass = 0; pass < kPasses && flipper.pass(); ++pass) {
  }
}

}  // namespace phront
