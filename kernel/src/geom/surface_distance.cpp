// Exact closest point and sign of a triangle mesh.
//
// Distance: best-first walk of a bounding-volume hierarchy with an exact point-triangle distance in
// double. The answer is the least (squared distance, triangle id) over all triangles, whatever the
// order of the walk: boxes never claim more than their content (see Bvh::squaredDistance), and both
// triangles on an edge compute its foot with the same bits. Hence a warm start changes the cost of
// a query and nothing else; so do the pieces that long triangles' boxes are cut into. Sign:
// angle-weighted pseudonormal of the face, edge or vertex that
// holds the foot (Baerentzen & Aanaes, "Signed distance computation using the angle weighted
// pseudonormal", 2005). Weak spots: their proof needs an embedded 2-manifold. Where a closed mesh
// is not one (edges of more than two triangles, points with several fans, zero-area triangles,
// triangles folded back onto their neighbour, gaps that do not count) the sign is asked of the
// winding number instead. A closed mesh whose triangles disagree about the outside has no sign and
// is refused; one that intersects itself elsewhere has none near the sheets inside it.
#include "phront/surface_distance.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "geom/block_query.h"
#include "geom/bvh.h"
#include "geom/closest_on_triangle.h"
#include "geom/face_phi.h"
#include "geom/gaps.h"
#include "geom/mesh_topology.h"
#include "geom/split_boxes.h"
#include "geom/winding_number.h"

namespace phront {

namespace {

// Across a side lies another triangle's side, nothing (free), or several triangles.
constexpr Index kFree = -1;
constexpr Index kSeveral = -2;

// Cosine between the normals of neighbours above which (negated) one is folded back onto the other:
// 0.0014 rad short of a full fold, sharper than the trailing edge of a blade.
constexpr double kFolded = 1 - 1e-6;

// Sine of the angle by which a query must lean over a free edge to be beyond it. Points advected
// straight off the border lean by rounding only (1e-16 times coordinate over distance).
constexpr double kBorderLean = 1e-9;

// Feet are rounded to a few ulps of the coordinates: less distance than that is none.
constexpr double kOnSurfaceUlps = 4;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Untrusted elements of a triangle, as bits of one byte: its face, its sides, its corners.
constexpr std::uint8_t kFaceBit = 1;
constexpr std::uint8_t sideBit(std::size_t k) { return static_cast<std::uint8_t>(2U << k); }
constexpr std::uint8_t cornerBit(std::size_t k) { return static_cast<std::uint8_t>(16U << k); }

std::size_t size(Index i) { return static_cast<std::size_t>(i); }

double cornerAngle(const QueryTriangle& t, std::size_t k) {
  const Vec3 u = t.corners[(k + 1) % 3] - t.corners[k];
  const Vec3 v = t.corners[(k + 2) % 3] - t.corners[k];
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

Result<void> checkInput(const TriMesh& mesh) {
  if (mesh.points.empty() || mesh.triangles.empty()) {
    return fail(ErrorCode::InvalidArgument,
                "The surface is empty: distances need at least one triangle.");
  }
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    if (!mesh.points[i].allFinite()) {
      return fail(ErrorCode::InvalidArgument,
                  fmt::format("Point {} of the surface is not finite; repair the mesh first.", i),
                  fmt::format("point {}", i));
    }
    if (!(mesh.points[i].cwiseAbs().maxCoeff() < kFarthest)) {
      return fail(ErrorCode::InvalidArgument,
                  fmt::format("Point {} of the surface lies farther off than {:g}.", i, kFarthest),
                  fmt::format("point {}", i));
    }
  }
  const auto count = static_cast<Index>(mesh.points.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const Index p : mesh.triangles[t]) {
      if (p >= 0 && p < count) continue;
      return fail(ErrorCode::InvalidArgument,
                  fmt::format("Triangle {} names point {}, but there are {} points.", t, p, count),
                  fmt::format("triangle {}", t));
    }
  }
  const bool labelsFit = (mesh.faceOf.empty() || mesh.faceOf.size() == mesh.triangles.size()) &&
                         (mesh.edgeOf.empty() || mesh.edgeOf.size() == 3 * mesh.triangles.size()) &&
                         (mesh.vertexOf.empty() || mesh.vertexOf.size() == mesh.points.size());
  if (!labelsFit) {
    return fail(ErrorCode::InvalidArgument,
                "The labels of the surface do not fit its size: faceOf needs one per triangle, "
                "edgeOf three per triangle, vertexOf one per point.");
  }
  return {};
}

FootPoint toFootPoint(const TriangleFoot& foot, Index triangle, double distance) {
  FootPoint result;
  result.point = foot.point;
  result.distance = distance;
  result.triangle = triangle;
  result.barycentric = foot.barycentric;
  result.kind = foot.kind;
  result.corner = foot.corner;
  return result;
}

}  // namespace

struct SurfaceDistance::Impl {
  TriMesh mesh;
  Box3 box;
  bool closed = true;                              // but for gaps
  bool hasSides = true;                            // else every sign is +1
  bool watertight = true;                          // no free sides
  std::array<Index, 2> disagreeing{kNone, kNone};  // neighbours turned against one another
  double onSurface = 0;

  Bvh bvh;                            // over triangles, for the winding number
  std::vector<QueryTriangle> leaves;  // in the order of the tree
  std::vector<Index> leafOf;          // triangle id -> position in leaves
  Bvh nearTree;                       // over pieces of triangles, for feet
  std::vector<QueryTriangle> nearLeaves;
  WindingTree winding;

  std::vector<Index> faceIds;  // sorted
  /// Some of the triangles, in a tree of their own.
  struct SubTree {
    Bvh tree;
    std::vector<Index> leaves;  // triangle ids in the order of the tree
  };
  std::vector<SubTree> faceTrees;  // one per face id; a single face has none

  /// A connected piece of the mesh: with SignRule::Union only.
  struct Part {
    SubTree triangles;
    Box3 box;
    bool outward = true;  // else it bounds a cavity
  };
  std::vector<Part> parts;
  std::vector<Index> partOf;  // triangle id -> part

  std::vector<Index> across;  // per side: the other triangle's side, kFree or kSeveral
  PointRings rings;
  std::vector<Vec3> pointNormals;
  std::vector<std::uint8_t> untrusted;

  Impl(TriMesh input, SignRule rule, double gap);
  void buildTrees(const TriangleBoxes& cover);
  void buildFaceTrees(const TriangleBoxes& cover);
  void buildParts(const MeshEdges& edges, const TriangleBoxes& cover);
  SubTree subTree(const TriangleBoxes& cover, std::vector<Index> pieces) const;
  void buildTopology(const MeshEdges& edges, double gap);
  void buildTrust(const MeshEdges& edges);

  const QueryTriangle& triangle(Index id) const { return leaves[size(leafOf[size(id)])]; }

  struct Best {
    double squared = std::numeric_limits<double>::infinity();
    Index id = std::numeric_limits<Index>::max();  // nothing yet: loses every tie
    TriangleFoot foot;
    bool found() const { return id != std::numeric_limits<Index>::max() && std::isfinite(squared); }
    void offer(const QueryTriangle& t, const Vec3& x) {
      const TriangleFoot f = closestOnTriangle(t, x);
      if (f.squared < squared || (f.squared == squared && t.id < id)) {
        squared = f.squared;
        id = t.id;
        foot = f;
      }
    }
  };
  double distanceOf(double squared) const {
    const double distance = std::sqrt(squared);
    return distance <= onSurface ? 0 : distance;
  }
  FootPoint footOf(const Best& best) const {
    return best.found() ? toFootPoint(best.foot, best.id, distanceOf(best.squared)) : FootPoint{};
  }
  FootPoint finish(const Best& best, const Vec3& x) const;
  /// Over this face, is the side of the face the sign?
  bool faceTellsSide(Index id) const {
    return parts.size() < 2 && !(closed && (untrusted[size(id)] & kFaceBit) != 0);
  }
  Vec3 pseudonormal(const FootPoint& foot) const;
  double sideOf(const Vec3& x, const FootPoint& foot) const;
  double signAt(const Vec3& x, const FootPoint& foot) const;
  FootPoint footOn(const SubTree& sub, const Vec3& x, double reach) const;
  bool leansOver(const Vec3& gap, Index side) const;
  bool beyond(const Vec3& x, const FootPoint& foot) const;
  int timesAround(const Vec3& x) const {
    return watertight ? winding.timesAround(x, bvh, leaves)
                      : static_cast<int>(std::lround(winding.at(x, bvh, leaves)));
  }
};

SurfaceDistance::Impl::Impl(TriMesh input, SignRule rule, double gap)
    : mesh(std::move(input)), box(boundingBox(mesh)), hasSides(rule != SignRule::Unsigned) {
  const double largest = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
  onSurface = kOnSurfaceUlps * std::numeric_limits<double>::epsilon() * largest;
  const TriangleBoxes cover = splitBoxes(mesh);
  buildTrees(cover);
  const MeshEdges edges = meshEdges(mesh);
  buildTopology(edges, gap);
  buildTrust(edges);
  if (closed && rule == SignRule::Union) buildParts(edges, cover);
}

void SurfaceDistance::Impl::buildTrees(const TriangleBoxes& cover) {
  const std::size_t count = mesh.triangles.size();
  std::vector<Box3> boxes(count);
  std::vector<Index> all(count);
  for (std::size_t t = 0; t < count; ++t) {
    for (const Index p : mesh.triangles[t]) boxes[t].extend(mesh.points[size(p)]);
    all[t] = static_cast<Index>(t);
  }
  bvh = Bvh(boxes, all);
  leaves.resize(count);
  leafOf.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Index id = bvh.order()[i];
    const auto& points = mesh.triangles[size(id)];
    leaves[i] = makeQueryTriangle(
        {mesh.points[size(points[0])], mesh.points[size(points[1])], mesh.points[size(points[2])]},
        points, id);
    leafOf[size(id)] = static_cast<Index>(i);
  }
  winding = WindingTree(bvh, leaves);

  if (cover.boxes.size() == count) {  // no triangle is in pieces
    nearTree = bvh;
    nearLeaves = leaves;
  } else {
    all.resize(cover.boxes.size());
    std::iota(all.begin(), all.end(), Index{0});
    nearTree = Bvh(cover.boxes, all);
    for (const Index piece : nearTree.order())
      nearLeaves.push_back(triangle(cover.triangle[size(piece)]));
  }
  buildFaceTrees(cover);
}

void SurfaceDistance::Impl::buildFaceTrees(const TriangleBoxes& cover) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    faceIds.push_back(mesh.face(static_cast<Index>(t)));
  std::sort(faceIds.begin(), faceIds.end());
  faceIds.erase(std::unique(faceIds.begin(), faceIds.end()), faceIds.end());
  if (faceIds.size() == 1) return;  // the tree of all triangles
  std::vector<std::vector<Index>> members(faceIds.size());
  for (std::size_t piece = 0; piece < cover.boxes.size(); ++piece) {
    const auto at =
        std::lower_bound(faceIds.begin(), faceIds.end(), mesh.face(cover.triangle[piece]));
    members[static_cast<std::size_t>(at - faceIds.begin())].push_back(static_cast<Index>(piece));
  }
  for (auto& list : members) faceTrees.push_back(subTree(cover, std::move(list)));
}

SurfaceDistance::Impl::SubTree SurfaceDistance::Impl::subTree(const TriangleBoxes& cover,
                                                              std::vector<Index> pieces) const {
  SubTree sub;
  sub.tree = Bvh(cover.boxes, std::move(pieces));
  for (const Index piece : sub.tree.order()) sub.leaves.push_back(cover.triangle[size(piece)]);
  return sub;
}

void SurfaceDistance::Impl::buildParts(const MeshEdges& edges, const TriangleBoxes& cover) {
  // Union-find over edges: the least triangle of a part is its root.
  std::vector<Index> root(mesh.triangles.size());
  std::iota(root.begin(), root.end(), Index{0});
  const auto find = [&](Index t) {
    while (root[size(t)] != t) t = root[size(t)] = root[size(root[size(t)])];
    return t;
  };
  for (const MeshEdge& edge : edges.edges) {
    const auto sides = edges.sidesOf(edge);
    for (const Index side : sides) {
      const Index a = find(sides[0] / 3);
      const Index b = find(side / 3);
      root[size(std::max(a, b))] = std::min(a, b);
    }
  }
  partOf.resize(root.size());
  std::vector<double> volumes;
  for (Index t = 0; t < static_cast<Index>(root.size()); ++t) {
    const Index r = find(t);
    if (r == t) {
      partOf[size(t)] = static_cast<Index>(parts.size());
      parts.emplace_back();
      volumes.push_back(0);
    }
    partOf[size(t)] = partOf[size(r)];
    const QueryTriangle& q = triangle(t);
    const Vec3 middle = box.center();
    volumes[size(partOf[size(t)])] +=
        (q.corners[0] - middle).dot((q.corners[1] - middle).cross(q.corners[2] - middle));
    for (const Vec3& corner : q.corners) parts[size(partOf[size(t)])].box.extend(corner);
  }
  std::vector<std::vector<Index>> members(parts.size());
  for (std::size_t piece = 0; piece < cover.boxes.size(); ++piece)
    members[size(partOf[size(cover.triangle[piece])])].push_back(static_cast<Index>(piece));
  for (std::size_t p = 0; p < parts.size(); ++p) {
    parts[p].outward = volumes[p] >= 0;
    parts[p].triangles = subTree(cover, std::move(members[p]));
  }
}

void SurfaceDistance::Impl::buildTopology(const MeshEdges& edges, double gap) {
  std::vector<Index> freeSides;
  across.assign(3 * mesh.triangles.size(), kFree);
  for (const MeshEdge& edge : edges.edges) {
    const auto sides = edges.sidesOf(edge);
    if (sides.size() == 1) freeSides.push_back(sides[0]);
    if (sides.size() == 2) {
      across[size(sides[0])] = sides[1];
      across[size(sides[1])] = sides[0];
      const bool opposite = sideStart(mesh, sides[0]) != sideStart(mesh, sides[1]);
      if (!opposite && disagreeing[0] == kNone) disagreeing = {sides[0] / 3, sides[1] / 3};
    }
    if (sides.size() > 2) {
      for (const Index side : sides) across[size(side)] = kSeveral;
    }
  }
  watertight = freeSides.empty();
  closed = !hasSides || watertight || (gap > 0 && onlyGaps(mesh, freeSides, gap));
  rings = pointRings(mesh);
  pointNormals.assign(mesh.points.size(), Vec3::Zero());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const QueryTriangle& q = triangle(static_cast<Index>(t));
    for (std::size_t k = 0; k < 3; ++k) {
      pointNormals[size(mesh.triangles[t][k])] += cornerAngle(q, k) * q.normal;
    }
  }
  for (Vec3& n : pointNormals) {
    const double length = n.norm();
    if (length > 0) n /= length;
  }
}

void SurfaceDistance::Impl::buildTrust(const MeshEdges& edges) {
  const std::size_t count = mesh.triangles.size();
  std::vector<bool> bad(count, false);
  for (std::size_t t = 0; t < count; ++t) {
    const Vec3& normal = triangle(static_cast<Index>(t)).normal;
    bad[t] = normal.isZero(0);
    for (std::size_t k = 0; k < 3 && !bad[t]; ++k) {
      const Index other = across[3 * t + k];
      bad[t] = other >= 0 && normal.dot(triangle(other / 3).normal) < -kFolded;
    }
  }
  std::vector<bool> badPoint = splitPoints(mesh, edges);
  for (std::size_t t = 0; t < count; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const bool astray = across[3 * t + k] == kSeveral || across[3 * t + k] == kFree;
      if (!bad[t] && !astray) continue;
      badPoint[size(mesh.triangles[t][k])] = true;
      badPoint[size(mesh.triangles[t][(k + 1) % 3])] = true;
    }
  }
  untrusted.assign(count, 0);
  for (std::size_t t = 0; t < count; ++t) {
    if (bad[t]) untrusted[t] |= kFaceBit;
    for (std::size_t k = 0; k < 3; ++k) {
      const Index other = across[3 * t + k];
      if (bad[t] || other == kSeveral || other == kFree || (other >= 0 && bad[size(other / 3)])) {
        untrusted[t] |= sideBit(k);
      }
      if (badPoint[size(mesh.triangles[t][k])]) untrusted[t] |= cornerBit(k);
    }
  }
}

Vec3 SurfaceDistance::Impl::pseudonormal(const FootPoint& foot) const {
  const auto k = size(foot.corner);
  if (foot.kind == FeatureKind::Vertex) {
    return pointNormals[size(mesh.triangles[size(foot.triangle)][k])];
  }
  Vec3 normal = triangle(foot.triangle).normal;
  if (foot.kind == FeatureKind::Edge) {
    const Index other = across[3 * size(foot.triangle) + k];
    if (other >= 0) normal += triangle(other / 3).normal;
    const double length = normal.norm();
    if (length > 0) normal /= length;
  }
  return normal;
}

// +1 or -1 by the mesh around a foot, which need not be the nearest.
double SurfaceDistance::Impl::sideOf(const Vec3& x, const FootPoint& foot) const {
  const auto k = size(foot.corner);
  const std::uint8_t bit = foot.kind == FeatureKind::Face   ? kFaceBit
                           : foot.kind == FeatureKind::Edge ? sideBit(k)
                                                            : cornerBit(k);
  if (closed && (untrusted[size(foot.triangle)] & bit) != 0) {
    return timesAround(x) > 0 ? -1 : 1;
  }
  const Vec3 gap = x - foot.point;
  return detail::dot<double>(gap, pseudonormal(foot)) < 0 ? -1 : 1;
}

double SurfaceDistance::Impl::signAt(const Vec3& x, const FootPoint& foot) const {
  if (foot.distance == 0 || !hasSides) return 1;
  const double side = sideOf(x, foot);
  if (parts.size() < 2) return side;
  // Times that parts wind around x: only those whose box holds it can.
  int times = 0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const Part& part = parts[p];
    if (!part.box.contains(x)) continue;
    const bool own = size(partOf[size(foot.triangle)]) == p;
    const double sideHere = own ? side : sideOf(x, footOn(part.triangles, x, kInfinity));
    if (part.outward && sideHere < 0) ++times;
    if (!part.outward && sideHere > 0) --times;
  }
  return times > 0 ? -1 : 1;
}

FootPoint SurfaceDistance::Impl::footOn(const SubTree& sub, const Vec3& x, double reach) const {
  Best best;
  best.squared = reach * reach;
  sub.tree.nearest(
      x, [&](Index i) { best.offer(triangle(sub.leaves[size(i)]), x); },
      [&] { return best.squared; });
  return footOf(best);
}

// Does the gap (query minus foot) lean outwards over a free side, within the triangle's plane?
bool SurfaceDistance::Impl::leansOver(const Vec3& gap, Index side) const {
  const QueryTriangle& t = triangle(side / 3);
  const auto k = size(side % 3);
  const Vec3 along = t.corners[(k + 1) % 3] - t.corners[k];
  const Vec3 outward = along.cross(t.normal);
  return gap.dot(outward) > kBorderLean * gap.norm() * outward.norm();
}

bool SurfaceDistance::Impl::beyond(const Vec3& x, const FootPoint& foot) const {
  if (closed || foot.kind == FeatureKind::Face || foot.distance == 0) return false;
  const Vec3 gap = x - foot.point;
  if (foot.kind == FeatureKind::Edge) {
    const Index side = 3 * foot.triangle + foot.corner;
    return across[size(side)] == kFree && leansOver(gap, side);
  }
  const Index point = mesh.triangles[size(foot.triangle)][size(foot.corner)];
  for (const Index t : rings.of(point)) {
    for (Index k = 0; k < 3; ++k) {
      const Index side = 3 * t + k;
      const bool touches = sideStart(mesh, side) == point || sideEnd(mesh, side) == point;
      if (touches && across[size(side)] == kFree && leansOver(gap, side)) return true;
    }
  }
  return false;
}

FootPoint SurfaceDistance::Impl::finish(const Best& best, const Vec3& x) const {
  FootPoint foot = footOf(best);
  if (foot.triangle == kNone) return foot;
  foot.sign = signAt(x, foot);
  foot.beyondBorder = beyond(x, foot);
  return foot;
}

Result<SurfaceDistance> SurfaceDistance::build(TriMesh mesh, SignRule rule, double gap) {
  if (auto ok = checkInput(mesh); !ok) return tl::unexpected(ok.error());
  auto impl = std::make_unique<const Impl>(std::move(mesh), rule, gap);
  if (const auto [a, b] = impl->disagreeing; impl->hasSides && impl->closed && a != kNone) {
    return fail(ErrorCode::InvalidArgument,
                fmt::format("Triangles {} and {} of the closed surface disagree about its outside; "
                            "orient the mesh first.",
                            a, b),
                fmt::format("triangle {}", a));
  }
  return SurfaceDistance(std::move(impl));
}

const TriMesh& SurfaceDistance::mesh() const { return impl_->mesh; }
const Box3& SurfaceDistance::box() const { return impl_->box; }
bool SurfaceDistance::closed() const { return impl_->closed; }
bool SurfaceDistance::watertight() const { return impl_->watertight; }

FootPoint SurfaceDistance::foot(const Vec3& x, double reach) const {
  const Impl& s = *impl_;
  Impl::Best best;
  best.squared = reach * reach;
  s.nearTree.nearest(
      x, [&](Index i) { best.offer(s.nearLeaves[size(i)], x); }, [&] { return best.squared; });
  return s.finish(best, x);
}

FootPoint SurfaceDistance::footFrom(const Vec3& x, Index start) const {
  const Impl& s = *impl_;
  if (start < 0 || size(start) >= s.leafOf.size()) return foot(x);
  Impl::Best best;
  best.offer(s.triangle(start), x);
  s.nearTree.nearest(
      x, [&](Index i) { best.offer(s.nearLeaves[size(i)], x); }, [&] { return best.squared; });
  return s.finish(best, x);
}

struct SurfaceDistance::BlockVisitor final : BlockQuery::Visitor {
  const Impl& surface;
  NodeBlock block;
  double reach;
  BlockPhi result;

  BlockVisitor(const Impl& s, const NodeBlock& nodes, double within)
      : surface(s), block(nodes), reach(within) {}

  void several(int node, std::span<const Index> candidates) override {
    const Vec3 x = block.position(node);
    Impl::Best best;
    for (const Index i : candidates) best.offer(surface.nearLeaves[size(i)], x);
    const FootPoint foot = surface.finish(best, x);
    hold(node, foot.distance, foot.sign, foot.beyondBorder ? kNone : foot.triangle);
  }

  void sole(const std::array<int, 3>& corner, unsigned which, Index candidate) override {
    const QueryTriangle& t = surface.nearLeaves[size(candidate)];
    FacePhi face;
    if (t.wellShaped && surface.faceTellsSide(t.id)) face = facePhi(t, block, corner);
    for (unsigned left = which; left != 0; left &= left - 1) {
      const auto c = static_cast<unsigned>(std::countr_zero(left));
      const int node = BlockQuery::nodeOf(corner, c);
      if ((face.over >> c & 1U) == 0) {
        several(node, {&candidate, 1});
        continue;
      }
      const double distance = surface.distanceOf(face.squared[c]);
      const bool under = surface.hasSides && distance > 0 && face.height[c] < 0;
      hold(node, distance, under ? -1 : 1, t.id);
    }
  }

 private:
  void hold(int node, double distance, double sign, Index triangle) {
    if (!(distance <= reach)) return;
    result.held[size(node >> 6)] |= std::uint64_t{1} << (node & 63);
    result.phi[size(node)] = sign * distance;
    result.triangle[size(node)] = triangle;
  }
};

BlockPhi SurfaceDistance::phiOnBlock(const Vec3& origin, double spacing,
                                     const std::array<std::int32_t, 3>& first, double reach,
                                     Index start) const {
  const Impl& s = *impl_;
  static thread_local BlockQuery query;  // for its memory
  BlockVisitor visitor(s, NodeBlock{origin, spacing, first}, reach);
  const bool known = start >= 0 && size(start) < s.leafOf.size();
  query.run(s.nearTree, s.nearLeaves, visitor.block, reach, known ? &s.triangle(start) : nullptr,
            visitor);
  return visitor.result;
}

FootPoint SurfaceDistance::footOnFace(const Vec3& x, Index face, double reach) const {
  const Impl& s = *impl_;
  const auto at = std::lower_bound(s.faceIds.begin(), s.faceIds.end(), face);
  if (at == s.faceIds.end() || *at != face) return {};
  if (s.faceTrees.empty()) {
    FootPoint found = foot(x, reach);
    found.sign = 1;
    found.beyondBorder = false;
    return found;
  }
  return s.footOn(s.faceTrees[static_cast<std::size_t>(at - s.faceIds.begin())], x, reach);
}

FootPoint SurfaceDistance::footOnTriangle(const Vec3& x, Index triangle) const {
  const Impl& s = *impl_;
  if (triangle < 0 || size(triangle) >= s.leafOf.size()) return {};
  Impl::Best best;
  best.offer(s.triangle(triangle), x);
  return s.footOf(best);
}

Feature SurfaceDistance::featureOf(const FootPoint& foot) const {
  const TriMesh& mesh = impl_->mesh;
  if (foot.triangle == kNone) return {};
  const auto k = size(foot.corner);
  const auto t = size(foot.triangle);
  if (foot.kind == FeatureKind::Vertex) {
    const Index point = mesh.triangles[t][k];
    const Index label = mesh.vertexOf.empty() ? kNone : mesh.vertexOf[size(point)];
    if (label != kNone) return {FeatureKind::Vertex, label};
    if (!mesh.edgeOf.empty()) {
      // A point inside a B-Rep edge: any labelled side that ends here names the edge.
      Index edge = kNone;
      for (const Index other : impl_->rings.of(point)) {
        for (Index j = 0; j < 3; ++j) {
          const Index side = 3 * other + j;
          const bool touches = sideStart(mesh, side) == point || sideEnd(mesh, side) == point;
          const Index id = touches ? mesh.edgeOf[size(side)] : kNone;
          if (id != kNone && (edge == kNone || id < edge)) edge = id;
        }
      }
      if (edge != kNone) return {FeatureKind::Edge, edge};
    }
  }
  if (foot.kind == FeatureKind::Edge && !mesh.edgeOf.empty()) {
    const Index label = mesh.edgeOf[3 * t + k];
    if (label != kNone) return {FeatureKind::Edge, label};
  }
  return {FeatureKind::Face, mesh.face(foot.triangle)};
}

Vec3 SurfaceDistance::gradient(const Vec3& x, const FootPoint& foot) const {
  if (foot.triangle == kNone) return Vec3::Zero();
  const Vec3 normal = impl_->pseudonormal(foot);
  const Vec3 gap = x - foot.point;
  const double length = gap.norm();
  if (foot.distance == 0 || !(length > 0)) return normal;
  const Vec3 direction = foot.sign / length * gap;
  // Over a well-shaped face the normal is the same direction without the rounding of a short gap.
  const bool exact = foot.kind == FeatureKind::Face && impl_->triangle(foot.triangle).wellShaped;
  return exact && direction.dot(normal) > 0.5 ? normal : direction;
}

double SurfaceDistance::windingNumber(const Vec3& x) const {
  return impl_->winding.at(x, impl_->bvh, impl_->leaves);
}
int SurfaceDistance::timesAround(const Vec3& x) const { return impl_->timesAround(x); }

SurfaceDistance::SurfaceDistance(std::unique_ptr<const Impl> impl) : impl_(std::move(impl)) {}
SurfaceDistance::SurfaceDistance(SurfaceDistance&&) noexcept = default;
SurfaceDistance& SurfaceDistance::operator=(SurfaceDistance&&) noexcept = default;
SurfaceDistance::~SurfaceDistance() = default;

}  // namespace phront
