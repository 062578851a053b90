// Dual marching cubes (Nielson 2004): the crossings on a cell's edges are chained over the cell's
// faces to loops; each loop gives one vertex, each crossed grid edge one quad around it.
//
// The dual of this is the polygon mesh of marching cubes, a closed manifold as long as neighbours
// agree on each face; on a face with four crossings they ask phi at its centre. The dual of a
// manifold is one, too, but in a mesh of indices two edges may join the same two vertices (Wenger
// 2013): when both segments of such a face belong to one loop on both sides. Wenger flips the
// face's decision; here each of the two edges gets a vertex of its own in the middle, which keeps
// the topology that phi's sample asked for. Diagonals of quads never coincide: two cells that are
// diagonal across a grid edge share just that edge.
#include "front/iso_topology.h"

#include <algorithm>
#include <map>

#include "base/parallel.h"

namespace phront {

namespace {

constexpr std::int64_t kGrain = 512;

/// Loops of one cell.
struct CellLoops {
  std::array<std::int8_t, 12> loopOfEdge{};  // -1: not crossed
  std::uint8_t count = 0;
  std::uint8_t centreInside = 0;  // bit per face with four crossings: phi(centre) < level
  std::uint8_t doubled = 0;       // bit per face: two segments of one loop
};

/// Corners of face 2a + side, in ring order around axis a.
std::array<int, 4> cornersOfFace(int face) {
  const int a = face / 2;
  const int b = 1 << ((a + 1) % 3);
  const int c = 1 << ((a + 2) % 3);
  const int base = (face % 2) << a;
  return {base, base + b, base + b + c, base + c};
}

/// Edges of a face; edge k joins ring corners k and k + 1.
std::array<int, 4> edgesOfFace(int face) {
  const int a = face / 2;
  const int side = face % 2;
  const int b = (a + 1) % 3;
  const int c = (a + 2) % 3;
  // Edge along b: its (b+1, b+2) are (c, a). Edge along c: its (c+1, c+2) are (a, b).
  return {4 * b + 2 * side, 4 * c + side + 2, 4 * b + 1 + 2 * side, 4 * c + side};
}

/// For a face with four crossings: segment 0 holds ring edge 0, segment 1 ring edge 2. Cutting off
/// the corners 1 and 3 pairs edges (0,1) and (2,3); cutting off 0 and 2 pairs (3,0) and (1,2).
bool cutsOddCorners(bool ringCorner0Inside, bool centreInside) {
  return ringCorner0Inside == centreInside;
}

bool insideAt(const GridCell& cell, int corner) { return ((cell.inside >> corner) & 1U) != 0; }

/// Pairs of linked ring edges of a face; -1: none.
struct Segments {
  std::array<int, 2> first{-1, -1};
  std::array<int, 2> second{-1, -1};
};

Segments segmentsOf(const GridCell& cell, int face, bool centreInside) {
  const auto corners = cornersOfFace(face);
  std::array<int, 4> crossed{};
  int count = 0;
  for (int k = 0; k < 4; ++k) {
    const bool here = insideAt(cell, corners[static_cast<std::size_t>(k)]);
    const bool next = insideAt(cell, corners[static_cast<std::size_t>((k + 1) % 4)]);
    if (here != next) crossed[static_cast<std::size_t>(count++)] = k;
  }
  if (count == 2) return {{crossed[0], crossed[1]}, {-1, -1}};
  if (count == 4) {
    if (cutsOddCorners(insideAt(cell, corners[0]), centreInside)) return {{0, 1}, {2, 3}};
    return {{0, 3}, {2, 1}};
  }
  return {};
}

CellLoops loopsOf(const SurfaceDistance& surface, const LevelGrid& grid, const GridCell& cell) {
  CellLoops loops;
  loops.loopOfEdge.fill(-1);
  std::array<std::array<int, 2>, 12> link{};
  for (auto& l : link) l = {-1, -1};
  const auto connect = [&](int e, int f) {
    for (const auto& [from, to] : {std::pair{e, f}, std::pair{f, e}}) {
      auto& slots = link[static_cast<std::size_t>(from)];
      (slots[0] < 0 ? slots[0] : slots[1]) = to;
    }
  };
  unsigned ambiguous = 0;
  for (int face = 0; face < 6; ++face) {
    const auto corners = cornersOfFace(face);
    const bool i0 = insideAt(cell, corners[0]);
    const bool four = i0 == insideAt(cell, corners[2]) && i0 != insideAt(cell, corners[1]) &&
                      i0 != insideAt(cell, corners[3]);
    bool centreInside = false;
    if (four) {
      ambiguous |= 1U << face;
      const auto a = static_cast<std::size_t>(face / 2);
      Vec3 centre = grid.position(cell.lower) + Vec3::Constant(0.5 * grid.spacing());
      GridIndex plane = cell.lower;  // one point for both cells, to the last bit
      plane[a] += face % 2;
      centre[static_cast<int>(a)] = grid.position(plane)[static_cast<int>(a)];
      centreInside = surface.foot(centre).phi() < grid.level();
      if (centreInside) loops.centreInside |= static_cast<std::uint8_t>(1U << face);
    }
    const auto edges = edgesOfFace(face);
    const Segments segments = segmentsOf(cell, face, centreInside);
    for (const auto& s : {segments.first, segments.second}) {
      if (s[0] < 0) continue;
      connect(edges[static_cast<std::size_t>(s[0])], edges[static_cast<std::size_t>(s[1])]);
    }
  }
  for (int start = 0; start < 12; ++start) {
    if (link[static_cast<std::size_t>(start)][0] < 0 ||
        loops.loopOfEdge[static_cast<std::size_t>(start)] >= 0) {
      continue;
    }
    int previous = -1;
    int edge = start;
    do {
      const auto e = static_cast<std::size_t>(edge);
      loops.loopOfEdge[e] = static_cast<std::int8_t>(loops.count);
      const int next = link[e][0] != previous ? link[e][0] : link[e][1];
      previous = edge;
      edge = next;
    } while (loops.loopOfEdge[static_cast<std::size_t>(edge)] < 0);
    ++loops.count;
  }
  for (int face = 0; face < 6; ++face) {
    if (((ambiguous >> face) & 1U) == 0) continue;
    const auto edges = edgesOfFace(face);
    if (loops.loopOfEdge[static_cast<std::size_t>(edges[0])] ==
        loops.loopOfEdge[static_cast<std::size_t>(edges[2])]) {
      loops.doubled |= static_cast<std::uint8_t>(1U << face);
    }
  }
  return loops;
}

/// Assembles sites and polygons from the loops of all cells.
class Assembler {
 public:
  Assembler(const LevelGrid& grid, const std::vector<CellLoops>& loops)
      : grid_(grid), loops_(loops) {}

  IsoTopology run() {
    const auto& cells = grid_.cells();
    firstSite_.reserve(cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
      firstSite_.push_back(static_cast<Index>(out_.sites.size()));
      for (int loop = 0; loop < loops_[i].count; ++loop) {
        IsoSite site{static_cast<Index>(i), 0};
        for (std::size_t e = 0; e < 12; ++e) {
          if (loops_[i].loopOfEdge[e] == loop) {
            site.edges = static_cast<std::uint16_t>(site.edges | (1U << e));
          }
        }
        out_.sites.push_back(site);
      }
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) addPolygon(static_cast<Index>(i), axis);
    }
    return std::move(out_);
  }

 private:
  // The four cells around a grid edge, counter-clockwise around its axis, by how far the cell lies
  // below the edge along the two other axes.
  static constexpr std::array<std::array<int, 2>, 4> kRing{{{1, 1}, {0, 1}, {0, 0}, {1, 0}}};

  void addPolygon(Index owner, int axis) {
    const GridCell& cell = grid_.cells()[static_cast<std::size_t>(owner)];
    const bool lowerInside = insideAt(cell, 0);
    if (lowerInside == insideAt(cell, 1 << axis)) return;
    std::array<Index, 4> around{};
    std::array<int, 4> edgeIn{};
    for (std::size_t k = 0; k < 4; ++k) {
      GridIndex at = cell.lower;
      at[static_cast<std::size_t>((axis + 1) % 3)] -= kRing[k][0];
      at[static_cast<std::size_t>((axis + 2) % 3)] -= kRing[k][1];
      around[k] = grid_.findCell(at);
      if (around[k] == kNone) return;  // only on open shells, at their border
      edgeIn[k] = 4 * axis + kRing[k][0] + 2 * kRing[k][1];
    }
    std::vector<Index> ring;
    std::size_t extra = 4;  // position of the first inserted site
    for (std::size_t k = 0; k < 4; ++k) {
      const auto c = static_cast<std::size_t>(around[k]);
      ring.push_back(firstSite_[c] + loops_[c].loopOfEdge[static_cast<std::size_t>(edgeIn[k])]);
      const Index middle = middleSite(around[k], around[(k + 1) % 4], axis, k, edgeIn[k]);
      if (middle == kNone) continue;
      if (extra == 4) extra = ring.size();
      ring.push_back(middle);
    }
    if (!lowerInside) std::ranges::reverse(ring);
    if (ring.size() == 4) {
      out_.quads.push_back({ring[0], ring[1], ring[2], ring[3]});
      return;
    }
    const std::size_t start = lowerInside ? extra : ring.size() - 1 - extra;
    std::ranges::rotate(ring, ring.begin() + static_cast<std::ptrdiff_t>(start));
    out_.polygons.push_back(std::move(ring));
  }

  /// The site between ring cells k and k + 1 when their common face is doubled on both sides.
  Index middleSite(Index cell, Index next, int axis, std::size_t k, int edge) {
    // Steps 0 and 2 of the ring go along axis + 1 (up, down), 1 and 3 along axis + 2.
    const int along = (axis + 1 + static_cast<int>(k % 2)) % 3;
    const int side = k < 2 ? 1 : 0;
    const int face = 2 * along + side;
    const int opposite = 2 * along + 1 - side;
    const CellLoops& loops = loops_[static_cast<std::size_t>(cell)];
    if (((loops.doubled >> face) & 1U) == 0) return kNone;
    if (((loops_[static_cast<std::size_t>(next)].doubled >> opposite) & 1U) == 0) return kNone;
    const GridCell& data = grid_.cells()[static_cast<std::size_t>(cell)];
    const auto edges = edgesOfFace(face);
    const Segments segments = segmentsOf(data, face, ((loops.centreInside >> face) & 1U) != 0);
    const auto holds = [&](const std::array<int, 2>& s) {
      return edges[static_cast<std::size_t>(s[0])] == edge ||
             edges[static_cast<std::size_t>(s[1])] == edge;
    };
    const int segment = holds(segments.first) ? 0 : 1;
    const auto& pair = segment == 0 ? segments.first : segments.second;
    GridIndex plane = data.lower;
    plane[static_cast<std::size_t>(along)] += side;
    const auto key = std::tuple{packKey(plane), along, segment};
    const auto found = middle_.find(key);
    if (found != middle_.end()) return found->second;
    const auto number = static_cast<Index>(out_.sites.size());
    const unsigned mask = (1U << edges[static_cast<std::size_t>(pair[0])]) |
                          (1U << edges[static_cast<std::size_t>(pair[1])]);
    out_.sites.push_back({cell, static_cast<std::uint16_t>(mask)});
    middle_.emplace(key, number);
    return number;
  }

  const LevelGrid& grid_;
  const std::vector<CellLoops>& loops_;
  IsoTopology out_;
  std::vector<Index> firstSite_;
  std::map<std::tuple<std::uint64_t, int, int>, Index> middle_;
};

}  // namespace

std::array<int, 2> cornersOfEdge(int edge) {
  const int a = edge / 4;
  const int lower = ((edge & 1) << ((a + 1) % 3)) | (((edge >> 1) & 1) << ((a + 2) % 3));
  return {lower, lower | (1 << a)};
}

IsoTopology isoTopology(const SurfaceDistance& surface, const LevelGrid& grid, int threads) {
  std::vector<CellLoops> loops(grid.cells().size());
  parallelFor(static_cast<std::int64_t>(loops.size()), threads, kGrain,
              [&](std::int64_t begin, std::int64_t end) {
                for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end);
                     ++i) {
                  loops[i] = loopsOf(surface, grid, grid.cells()[i]);
                }
              });
  return Assembler(grid, loops).run();
}

}  // namespace phront
