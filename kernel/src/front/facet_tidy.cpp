// Points that were moved into the same planes may coincide, and collapses may leave needles: both
// are legal in a mesh and poison in a B-Rep, where a side needs a direction and a face a normal.
//
// Two local steps, both of which keep every side used once each way: contracting a side (both ends
// become one point, loops that shrink below a triangle vanish), and giving a flat triangle to its
// neighbour beyond the longest side, whose loop then runs through the third corner. A contraction
// that would join two sides into one with more than two users, or change the border, is taken back.
#include "front/facet_tidy.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace phront::facet {
namespace {

using Loop = std::vector<Index>;

// Each pass may uncover new needles; in practice two suffice.
constexpr int kMaxPasses = 6;

using Sides = std::set<std::pair<Index, Index>>;

/// Sides that are used one way only; empty when one is used twice the same way.
std::optional<Sides> borderOf(const FacetedSurface& surface) {
  Sides sides;
  for (const FacetPolygon& polygon : surface.polygons)
    for (const Loop& loop : polygon.loops)
      for (std::size_t k = 0; k < loop.size(); ++k)
        if (!sides.insert({loop[k], loop[(k + 1) % loop.size()]}).second) return std::nullopt;
  Sides border;
  for (const auto& [a, b] : sides)
    if (!sides.contains({b, a})) border.insert({a, b});
  return border;
}

/// A loop without repeated points in a row and without spikes (x, y, x).
Loop tidied(Loop loop) {
  bool changed = true;
  while (changed && loop.size() >= 3) {
    changed = false;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const std::size_t next = (k + 1) % loop.size();
      const std::size_t afterNext = (k + 2) % loop.size();
      if (loop[k] != loop[next] && loop[k] != loop[afterNext]) continue;
      loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(next));
      changed = true;
      break;
    }
  }
  return loop;
}

/// The triangle's corners, smallest first, in its own direction.
std::array<Index, 3> canonical(const Loop& loop) {
  const auto first = std::min_element(loop.begin(), loop.end()) - loop.begin();
  return {loop[first], loop[(first + 1) % 3], loop[(first + 2) % 3]};
}

/// Removes pairs of triangles at a point that cover each other back to back: a pocket without
/// volume.
void cancelFins(FacetedSurface& surface, Index point) {
  std::map<std::array<Index, 3>, std::size_t> triangles;
  for (std::size_t p = 0; p < surface.polygons.size(); ++p) {
    std::vector<Loop>& loops = surface.polygons[p].loops;
    if (loops.size() != 1 || loops[0].size() != 3) continue;
    if (std::find(loops[0].begin(), loops[0].end(), point) == loops[0].end()) continue;
    const std::array<Index, 3> key = canonical(loops[0]);
    const auto back = triangles.find({key[0], key[2], key[1]});
    if (back == triangles.end()) {
      triangles[key] = p;
      continue;
    }
    surface.polygons[back->second].loops.clear();
    loops.clear();
    triangles.erase(back);
  }
  std::erase_if(surface.polygons,
                [](const FacetPolygon& polygon) { return polygon.loops.empty(); });
}

void contract(FacetedSurface& surface, Index gone, Index kept) {
  std::vector<FacetPolygon> polygons;
  polygons.reserve(surface.polygons.size());
  for (FacetPolygon& polygon : surface.polygons) {
    const auto holds = [&](const Loop& loop) {
      return std::find(loop.begin(), loop.end(), gone) != loop.end();
    };
    if (std::none_of(polygon.loops.begin(), polygon.loops.end(), holds)) {
      polygons.push_back(std::move(polygon));
      continue;
    }
    FacetPolygon left{.feature = polygon.feature, .plane = polygon.plane, .loops = {}};
    for (std::size_t l = 0; l < polygon.loops.size(); ++l) {
      Loop loop = polygon.loops[l];
      std::replace(loop.begin(), loop.end(), gone, kept);
      loop = tidied(std::move(loop));
      if (loop.size() >= 3)
        left.loops.push_back(std::move(loop));
      else if (l == 0)
        break;  // without its outer loop there is no polygon
    }
    if (!left.loops.empty()) polygons.push_back(std::move(left));
  }
  surface.polygons = std::move(polygons);
  cancelFins(surface, kept);
}

std::vector<std::pair<Index, Index>> shortSides(const FacetedSurface& surface, double floor) {
  std::set<std::pair<Index, Index>> found;
  for (const FacetPolygon& polygon : surface.polygons)
    for (const Loop& loop : polygon.loops)
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const Index a = loop[k];
        const Index b = loop[(k + 1) % loop.size()];
        if (a < b && (surface.points[a] - surface.points[b]).norm() < floor) found.insert({a, b});
      }
  return {found.begin(), found.end()};
}

bool contractShortSides(FacetedSurface& surface, double floor) {
  bool changed = false;
  const std::vector<std::pair<Index, Index>> sides = shortSides(surface, floor);
  if (sides.empty()) return false;
  const std::optional<Sides> border = borderOf(surface);
  for (const auto& [a, b] : sides) {
    FacetedSurface tried = surface;
    contract(tried, b, a);
    if (borderOf(tried) != border) continue;
    surface = std::move(tried);
    changed = true;
  }
  return changed;
}

/// Side of a triangle opposite to which its height is smallest: the longest. Empty if not flat.
std::optional<int> flatSide(const FacetedSurface& surface, const Loop& loop, double floor) {
  int longest = 0;
  double length = 0;
  for (int k = 0; k < 3; ++k) {
    const double l = (surface.points[loop[(k + 1) % 3]] - surface.points[loop[k]]).norm();
    if (l > length) {
      length = l;
      longest = k;
    }
  }
  const Vec3& a = surface.points[loop[0]];
  const double twiceArea = (surface.points[loop[1]] - a).cross(surface.points[loop[2]] - a).norm();
  if (length > 0 && twiceArea >= floor * length) return std::nullopt;
  return longest;
}

bool giveAwayFlatTriangles(FacetedSurface& surface, double floor) {
  struct Place {
    std::size_t polygon;
    std::size_t loop;
  };
  std::map<std::pair<Index, Index>, Place> sides;
  const auto enter = [&](std::size_t p, std::size_t l) {
    const Loop& loop = surface.polygons[p].loops[l];
    for (std::size_t k = 0; k < loop.size(); ++k)
      sides[{loop[k], loop[(k + 1) % loop.size()]}] = {p, l};
  };
  for (std::size_t p = 0; p < surface.polygons.size(); ++p)
    for (std::size_t l = 0; l < surface.polygons[p].loops.size(); ++l) enter(p, l);
  bool changed = false;
  for (std::size_t p = 0; p < surface.polygons.size(); ++p) {
    const FacetPolygon& polygon = surface.polygons[p];
    if (polygon.loops.size() != 1 || polygon.loops[0].size() != 3) continue;
    const Loop loop = polygon.loops[0];
    const std::optional<int> side = flatSide(surface, loop, floor);
    if (!side) continue;
    const Index a = loop[*side];
    const Index b = loop[(*side + 1) % 3];
    const Index c = loop[(*side + 2) % 3];
    const auto beyond = sides.find({b, a});
    if (beyond == sides.end() || beyond->second.polygon == p) continue;
    const Place place = beyond->second;
    Loop& taker = surface.polygons[place.polygon].loops[place.loop];
    if (std::find(taker.begin(), taker.end(), c) != taker.end()) continue;
    const auto at = std::find(taker.begin(), taker.end(), b);
    taker.insert(at + 1, c);
    for (int k = 0; k < 3; ++k) sides.erase({loop[k], loop[(k + 1) % 3]});
    sides.erase({b, a});
    enter(place.polygon, place.loop);
    surface.polygons[p].loops.clear();
    changed = true;
  }
  std::erase_if(surface.polygons,
                [](const FacetPolygon& polygon) { return polygon.loops.empty(); });
  return changed;
}

}  // namespace

void tidyFacets(FacetedSurface& surface, double floor) {
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    const bool contracted = contractShortSides(surface, floor);
    if (!giveAwayFlatTriangles(surface, floor) && !contracted) return;
  }
}

}  // namespace phront::facet
