// Dual marching cubes (Nielson 2004): the crossings on a cell's edges are chained over the cell's
// sides to loops; each loop gives one vertex, each crossed edge one polygon around it.
//
// The dual of this is the polygon mesh of marching cubes, a closed manifold as long as neighbours
// agree on each side; on a side with four crossings they ask phi at its centre. Beside finer cells
// the edges and sides are the smallest ones, which both neighbours see, so the same holds there;
// edges between two cells of one size and a larger one give triangles.
// The dual of a manifold is one, too, but in a mesh of indices two edges may join the same two
// vertices (Wenger 2013): when both segments of such a side belong to one loop in both cells.
// Wenger flips the side's decision; here each of the two edges gets a vertex of its own in the
// middle, which keeps the topology that phi's sample asked for. Diagonals of quads never coincide:
// two cells that are diagonal across an edge share just that edge, crossed once.
#include "front/iso_topology.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/parallel.h"

namespace phront {

namespace {

constexpr std::int64_t kGrain = 512;

/// A shortest edge or smallest side: its lowest node and its axis tell it from all others.
std::uint64_t keyOf(Index lowest, std::size_t axis) {
  return 3 * static_cast<std::uint64_t>(lowest) + axis;
}

/// A crossing as one cell sees it.
struct CellCrossing {
  Crossing ends{};
  std::size_t axis = 0;
  int loop = -1;
  std::array<int, 2> links{-1, -1};  // to the crossings that follow over the two sides around it

  [[nodiscard]] std::uint64_t key() const { return keyOf(ends[0], axis); }
};

/// A side whose two segments belong to one loop.
struct DoubledSide {
  std::uint64_t side = 0;
  std::array<std::array<Crossing, 2>, 2> segments{};
};

struct CellLoops {
  std::vector<CellCrossing> crossings;
  int count = 0;
  std::vector<DoubledSide> doubled;
};

/// Chains the crossings of one cell.
class LoopFinder {
 public:
  LoopFinder(const SurfaceDistance& surface, const LevelGrid& grid, const GridCell& cell)
      : surface_(surface), grid_(grid), cell_(cell) {}

  CellLoops run() {
    for (std::size_t face = 0; face < 6; ++face) {
      const std::size_t axis = face / 2;
      GridIndex lower = cell_.lower;
      if (face % 2 == 1) lower[axis] += cell_.size;
      forSmallestSides(grid_, lower, cell_.size, axis, cell_.hanging,
                       [&](const GridIndex& at, std::int32_t size) { chain(at, size, face); });
    }
    number();
    for (const Ambiguous& side : ambiguous_) {
      const auto& [first, second] = side.segments;
      if (crossing(first[0]).loop != crossing(second[0]).loop) continue;
      DoubledSide doubled{side.key, {}};
      for (std::size_t s = 0; s < 2; ++s) {
        for (std::size_t end = 0; end < 2; ++end) {
          doubled.segments[s][end] = crossing(side.segments[s][end]).ends;
        }
      }
      loops_.doubled.push_back(doubled);
    }
    return std::move(loops_);
  }

 private:
  struct Ambiguous {
    std::uint64_t key = 0;
    std::array<std::array<int, 2>, 2> segments{};
  };

  CellCrossing& crossing(int i) { return loops_.crossings[static_cast<std::size_t>(i)]; }

  int numberOf(Index low, Index high, std::size_t axis) {
    const auto found = std::ranges::find_if(loops_.crossings, [&](const CellCrossing& c) {
      return c.ends[0] == low && c.axis == axis;
    });
    if (found != loops_.crossings.end()) {
      return static_cast<int>(found - loops_.crossings.begin());
    }
    loops_.crossings.push_back({.ends = {low, high}, .axis = axis});
    return static_cast<int>(loops_.crossings.size()) - 1;
  }

  void link(int a, int b) {
    for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, a}}) {
      auto& links = crossing(from).links;
      (links[0] < 0 ? links[0] : links[1]) = to;
    }
  }

  /// Links the crossings on the border of a smallest side in pairs.
  void chain(const GridIndex& lower, std::int32_t size, std::size_t face) {
    const std::size_t axis = face / 2;
    const std::size_t b = (axis + 1) % 3;
    const std::size_t c = (axis + 2) % 3;
    std::array<Index, 4> corner{};  // in ring order around the axis
    for (std::size_t k = 0; k < 4; ++k) {
      const bool upperB = k == 1 || k == 2;
      const bool upperC = k == 2 || k == 3;
      if (size == cell_.size) {
        const std::size_t bits =
            (face % 2) << axis | std::size_t{upperB} << b | std::size_t{upperC} << c;
        corner[k] = cell_.node[bits];
        continue;
      }
      GridIndex at = lower;
      if (upperB) at[b] += size;
      if (upperC) at[c] += size;
      corner[k] = grid_.findNode(at);
    }
    std::vector<int>& ring = ring_;
    ring.clear();
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t first = ring.size();
      const std::size_t along = k % 2 == 0 ? b : c;
      const Index low = corner[k < 2 ? k : (k + 1) % 4];
      const Index high = corner[k < 2 ? k + 1 : k];
      const auto visit = [&](Index from, Index to) {
        if (grid_.inside(from) != grid_.inside(to)) ring.push_back(numberOf(from, to, along));
      };
      if (cell_.hanging) {
        forShortestEdges(grid_, low, high, size, along, visit);
      } else {
        visit(low, high);
      }
      if (k >= 2) std::reverse(ring.begin() + static_cast<std::ptrdiff_t>(first), ring.end());
    }
    if (ring.size() == 2) link(ring[0], ring[1]);
    if (ring.size() < 4) return;
    // The runs of nodes of the other sign than the centre are cut off.
    Vec3 centre = grid_.position(lower);
    centre[static_cast<int>(b)] += 0.5 * grid_.length(size);
    centre[static_cast<int>(c)] += 0.5 * grid_.length(size);
    const bool centreInside = surface_.foot(centre).phi() < grid_.level();
    const std::size_t start = grid_.inside(corner[0]) == centreInside ? 0 : 1;
    for (std::size_t k = 0; k < ring.size(); k += 2) {
      link(ring[start + k], ring[(start + k + 1) % ring.size()]);
    }
    if (ring.size() == 4) {
      ambiguous_.push_back(
          {keyOf(corner[0], axis),
           {{{ring[start], ring[start + 1]}, {ring[start + 2], ring[(start + 3) % 4]}}}});
    }
  }

  void number() {
    for (int start = 0; start < static_cast<int>(loops_.crossings.size()); ++start) {
      if (crossing(start).loop >= 0) continue;
      int previous = -1;
      int at = start;
      do {
        CellCrossing& here = crossing(at);
        here.loop = loops_.count;
        const int next = here.links[0] != previous ? here.links[0] : here.links[1];
        previous = at;
        at = next;
      } while (crossing(at).loop < 0);
      ++loops_.count;
    }
  }

  const SurfaceDistance& surface_;
  const LevelGrid& grid_;
  const GridCell& cell_;
  CellLoops loops_;
  std::vector<Ambiguous> ambiguous_;
  std::vector<int> ring_;
};

/// Assembles sites and polygons from the loops of all cells.
class Assembler {
 public:
  Assembler(const LevelGrid& grid, const std::vector<CellLoops>& loops)
      : grid_(grid), loops_(loops) {}

  IsoTopology run() {
    for (std::size_t i = 0; i < loops_.size(); ++i) addSites(static_cast<Index>(i));
    for (const Edge& edge : edges_) addPolygon(edge);
    return std::move(out_);
  }

 private:
  /// A crossed edge with the cells and their sites in its four quadrants, counter-clockwise around
  /// its axis; a cell whose side it divides has two of them.
  struct Edge {
    Crossing ends{};
    std::size_t axis = 0;
    std::array<Index, 4> cell{kNone, kNone, kNone, kNone};
    std::array<Index, 4> site{kNone, kNone, kNone, kNone};
  };

  void addSites(Index number) {
    const CellLoops& loops = loops_[static_cast<std::size_t>(number)];
    for (int loop = 0; loop < loops.count; ++loop) {
      const auto site = static_cast<Index>(out_.sites.size());
      const auto first = static_cast<Index>(out_.crossings.size());
      for (const CellCrossing& crossing : loops.crossings) {
        if (crossing.loop != loop) continue;
        out_.crossings.push_back(crossing.ends);
        addToEdge(crossing, number, site);
      }
      const auto count = static_cast<Index>(out_.crossings.size()) - first;
      out_.sites.push_back({number, first, count, loops.count == 1});
    }
  }

  void addToEdge(const CellCrossing& crossing, Index number, Index site) {
    const auto next = static_cast<Index>(edges_.size());
    const Index at = edgeOf_.insert(crossing.key(), next);
    if (at == next) edges_.push_back({.ends = crossing.ends, .axis = crossing.axis});
    Edge& edge = edges_[static_cast<std::size_t>(at)];
    const GridCell& cell = grid_.cells()[static_cast<std::size_t>(number)];
    const GridIndex& low = grid_.indexOf(crossing.ends[0]);
    const std::size_t u = (crossing.axis + 1) % 3;
    const std::size_t v = (crossing.axis + 2) % 3;
    // Upper and lower side of the edge that the cell covers.
    const std::array<bool, 2> inU{low[u]<cell.lower[u] + cell.size, low[u]> cell.lower[u]};
    const std::array<bool, 2> inV{low[v]<cell.lower[v] + cell.size, low[v]> cell.lower[v]};
    static constexpr std::array<std::array<std::size_t, 2>, 4> kQuadrants{
        {{1, 1}, {0, 1}, {0, 0}, {1, 0}}};
    for (std::size_t q = 0; q < 4; ++q) {
      if (!inU[kQuadrants[q][0]] || !inV[kQuadrants[q][1]]) continue;
      edge.cell[q] = number;
      edge.site[q] = site;
    }
  }

  void addPolygon(const Edge& edge) {
    if (std::ranges::find(edge.site, kNone) != edge.site.end()) return;  // borders of open shells
    std::vector<std::size_t> around;                                     // a quadrant for each cell
    for (std::size_t q = 0; q < 4; ++q) {
      if (edge.cell[q] != edge.cell[(q + 3) % 4]) around.push_back(q);
    }
    std::vector<Index> ring;
    std::size_t extra = 8;  // position of the first inserted site
    for (std::size_t k = 0; k < around.size(); ++k) {
      ring.push_back(edge.site[around[k]]);
      const Index middle =
          middleSite(edge.cell[around[k]], edge.cell[around[(k + 1) % around.size()]], edge.ends);
      if (middle == kNone) continue;
      extra = std::min(extra, ring.size());
      ring.push_back(middle);
    }
    const bool extended = extra < 8;
    const bool lowerInside = grid_.inside(edge.ends[0]);
    if (!lowerInside) std::ranges::reverse(ring);
    if (ring.size() == 4 && !extended) {
      out_.quads.push_back({ring[0], ring[1], ring[2], ring[3]});
      return;
    }
    if (extended) {
      const std::size_t start = lowerInside ? extra : ring.size() - 1 - extra;
      std::ranges::rotate(ring, ring.begin() + static_cast<std::ptrdiff_t>(start));
    }
    out_.polygons.push_back(std::move(ring));
  }

  /// The site between two cells around a crossed edge when their common side is doubled in both.
  Index middleSite(Index cell, Index next, const Crossing& edge) {
    const std::vector<DoubledSide>& here = loops_[static_cast<std::size_t>(cell)].doubled;
    const std::vector<DoubledSide>& there = loops_[static_cast<std::size_t>(next)].doubled;
    if (here.empty() || there.empty()) return kNone;
    for (const DoubledSide& side : here) {
      const bool common = std::ranges::any_of(
          there, [&](const DoubledSide& other) { return other.side == side.side; });
      if (!common) continue;
      for (const auto& segment : side.segments) {
        if (std::ranges::find(segment, edge) == segment.end()) continue;
        const auto [at, isNew] = middle_.try_emplace({side.side, std::min(segment[0], segment[1])},
                                                     static_cast<Index>(out_.sites.size()));
        if (isNew) {
          const auto first = static_cast<Index>(out_.crossings.size());
          out_.crossings.insert(out_.crossings.end(), segment.begin(), segment.end());
          out_.sites.push_back({cell, first, 2, false});
        }
        return at->second;
      }
    }
    return kNone;
  }

  const LevelGrid& grid_;
  const std::vector<CellLoops>& loops_;
  IsoTopology out_;
  std::vector<Edge> edges_;
  KeyMap edgeOf_;
  std::map<std::pair<std::uint64_t, Crossing>, Index> middle_;
};

}  // namespace

IsoTopology isoTopology(const SurfaceDistance& surface, const LevelGrid& grid, int threads) {
  std::vector<CellLoops> loops(grid.cells().size());
  parallelFor(static_cast<std::int64_t>(loops.size()), threads, kGrain,
              [&](std::int64_t begin, std::int64_t end) {
                for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end);
                     ++i) {
                  loops[i] = LoopFinder(surface, grid, grid.cells()[i]).run();
                }
              });
  return Assembler(grid, loops).run();
}

}  // namespace phront
