// Polygons out of the triangles that lie in one plane.
//
// Connected triangles of one plane form a region. Its border half-edges are chained by turning
// around their end point inside the region, so chains never cross; a chain that meets a point twice
// is cut into two loops there. Loops that run counter-clockwise are outer loops, the others holes
// of the smallest outer loop around them. A region whose loops are not simple, or touch one
// another, is given out as its triangles. Points on a straight border between exactly two polygons
// are dropped.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "front/facet_mesh.h"
#include "front/loops_2d.h"

namespace phront::facet {

namespace {

// A dropped point may lie this part of the diagonal off the side that replaces it.
constexpr double kCollinear = 1e-11;

using Loop = std::vector<Index>;
using Region = std::vector<Index>;  // triangles

std::vector<Region> regionsOf(const WorkMesh& mesh, std::vector<Index>& regionOf) {
  std::vector<Region> regions;
  regionOf.assign(mesh.corners.size(), kNone);
  for (Index seed = 0; seed < mesh.triangleCount(); ++seed) {
    if (!mesh.alive(seed) || mesh.frozen(seed) || regionOf[seed] != kNone) continue;
    const auto id = static_cast<Index>(regions.size());
    Region region{seed};
    regionOf[seed] = id;
    for (std::size_t i = 0; i < region.size() && mesh.plane[seed] != kNone; ++i) {
      for (int k = 0; k < 3; ++k) {
        const Index other = mesh.across(region[i], k);
        if (other == kNone || mesh.frozen(other) || regionOf[other] != kNone) continue;
        if (mesh.plane[other] != mesh.plane[seed]) continue;
        regionOf[other] = id;
        region.push_back(other);
      }
    }
    regions.push_back(std::move(region));
  }
  return regions;
}

/// Cuts a closed chain at points it meets twice.
void cutIntoLoops(const Loop& chain, std::vector<Loop>& loops) {
  Loop open;
  std::map<Index, std::size_t> at;
  for (const Index p : chain) {
    const auto seen = at.find(p);
    if (seen != at.end()) {
      const auto start = open.begin() + static_cast<std::ptrdiff_t>(seen->second);
      loops.emplace_back(start, open.end());
      for (auto q = start; q != open.end(); ++q) at.erase(*q);
      open.erase(start, open.end());
    }
    at[p] = open.size();
    open.push_back(p);
  }
  loops.push_back(std::move(open));
}

std::vector<Loop> bordersOf(const WorkMesh& mesh, const Region& region,
                            const std::vector<Index>& regionOf) {
  const Index id = regionOf[region.front()];
  const auto inside = [&](Index t) { return t != kNone && regionOf[t] == id; };
  std::set<std::array<Index, 2>> done;  // triangle, side
  std::vector<Loop> loops;
  for (const Index seed : region) {
    for (int side = 0; side < 3; ++side) {
      if (inside(mesh.across(seed, side)) || done.contains({seed, side})) continue;
      Loop chain;
      Index t = seed;
      int k = side;
      while (done.insert({t, k}).second) {
        chain.push_back(mesh.corners[t][k]);
        const Index turn = mesh.corners[t][(k + 1) % 3];
        k = (k + 1) % 3;
        for (Index next = mesh.across(t, k); inside(next); next = mesh.across(t, k)) {
          t = next;
          k = mesh.cornerOf(t, turn);
        }
      }
      cutIntoLoops(chain, loops);
    }
  }
  return loops;
}

FacetPolygon trianglePolygon(const WorkMesh& mesh, Index t, std::span<const Feature> labels) {
  FacetPolygon polygon;
  polygon.feature = labels[mesh.label[t]];
  if (mesh.plane[t] != kNone) {
    polygon.plane = mesh.planes[mesh.plane[t]];
  } else {
    polygon.plane.normal = mesh.areaVector(t).normalized();
    polygon.plane.offset = polygon.plane.normal.dot(mesh.centroid(t));
  }
  polygon.loops = {{mesh.corners[t].begin(), mesh.corners[t].end()}};
  return polygon;
}

/// What most of a region stems from: a plane also takes in neighbours that leave it by little.
Index mainLabel(const WorkMesh& mesh, const Region& region) {
  std::map<Index, double> area;
  for (const Index t : region) area[mesh.label[t]] += mesh.areaVector(t).norm();
  return std::max_element(area.begin(), area.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

/// The polygons of a plane region; empty when its loops cannot bound faces.
std::vector<FacetPolygon> regionPolygons(const WorkMesh& mesh, const Context& context,
                                         const Region& region, const std::vector<Loop>& loops,
                                         std::span<const Feature> labels) {
  const Plane& plane = mesh.planes[mesh.plane[region.front()]];
  const Vec3 x = plane.normal.unitOrthogonal();
  const Vec3 y = plane.normal.cross(x);
  std::vector<Loop2d> flat;
  for (const Loop& loop : loops) {
    Loop2d points;
    for (const Index p : loop) {
      const Vec3 v = mesh.points[p] - context.center;
      points.push_back({x.dot(v), y.dot(v), p});
    }
    flat.push_back(std::move(points));
  }
  if (!loopsAreSimple(flat, context.heightFloor)) return {};
  const auto nesting = nestLoops(flat);
  if (!nesting) return {};
  std::vector<FacetPolygon> polygons;
  const Feature feature = labels[mainLabel(mesh, region)];
  for (const auto& group : *nesting) {
    FacetPolygon polygon;
    polygon.feature = feature;
    polygon.plane = plane;
    for (const std::size_t l : group) polygon.loops.push_back(loops[l]);
    polygons.push_back(std::move(polygon));
  }
  return polygons;
}

/// Drops points, but the first `fixed`, on straight borders between two polygons.
void dropCollinear(FacetedSurface& surface, Index fixed, double tolerance) {
  struct Visit {
    std::size_t polygon = 0;
    std::size_t loop = 0;
    Index before = kNone;
    Index after = kNone;
  };
  std::vector<std::vector<Visit>> visits(surface.points.size());
  std::set<std::array<Index, 2>> sides;
  for (std::size_t i = 0; i < surface.polygons.size(); ++i) {
    for (std::size_t l = 0; l < surface.polygons[i].loops.size(); ++l) {
      const Loop& loop = surface.polygons[i].loops[l];
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const Index after = loop[(k + 1) % loop.size()];
        visits[loop[k]].push_back({i, l, loop[(k + loop.size() - 1) % loop.size()], after});
        sides.insert({loop[k], after});
      }
    }
  }
  for (Index p = fixed; p < static_cast<Index>(surface.points.size()); ++p) {
    if (visits[p].size() != 2) continue;
    // Neighbours in a loop change as points go: look them up anew.
    std::array<Loop*, 2> loops{};
    std::array<std::size_t, 2> at{};
    for (int v = 0; v < 2; ++v) {
      loops[v] = &surface.polygons[visits[p][v].polygon].loops[visits[p][v].loop];
      at[v] = static_cast<std::size_t>(std::find(loops[v]->begin(), loops[v]->end(), p) -
                                       loops[v]->begin());
    }
    if (loops[0] == loops[1] || loops[0]->size() < 4 || loops[1]->size() < 4) continue;
    const std::size_t n = loops[0]->size();
    const Index a = (*loops[0])[(at[0] + n - 1) % n];
    const Index b = (*loops[0])[(at[0] + 1) % n];
    if (sides.contains({a, b}) || sides.contains({b, a})) continue;
    const Vec3 side = surface.points[b] - surface.points[a];
    const Vec3 offset = surface.points[p] - surface.points[a];
    const double along = side.dot(offset) / std::max(side.squaredNorm(), 1e-300);
    if (along <= 0 || along >= 1 || (offset - along * side).norm() > tolerance) continue;
    for (int v = 0; v < 2; ++v) {
      loops[v]->erase(loops[v]->begin() + static_cast<std::ptrdiff_t>(at[v]));
    }
    sides.insert({a, b});
    sides.insert({b, a});
  }
}

/// Keeps the points that polygons use, in their order.
void dropUnusedPoints(FacetedSurface& surface) {
  std::vector<Index> renumbered(surface.points.size(), kNone);
  for (const FacetPolygon& polygon : surface.polygons) {
    for (const Loop& loop : polygon.loops) {
      for (const Index p : loop) renumbered[p] = 0;
    }
  }
  std::vector<Vec3> used;
  for (std::size_t p = 0; p < renumbered.size(); ++p) {
    if (renumbered[p] == kNone) continue;
    renumbered[p] = static_cast<Index>(used.size());
    used.push_back(surface.points[p]);
  }
  surface.points = std::move(used);
  for (FacetPolygon& polygon : surface.polygons) {
    for (Loop& loop : polygon.loops) {
      for (Index& p : loop) p = renumbered[p];
    }
  }
}

}  // namespace

FacetedSurface mergePlanes(const WorkMesh& mesh, const Context& context,
                           std::span<const Feature> labels) {
  std::vector<Index> regionOf;
  const std::vector<Region> regions = regionsOf(mesh, regionOf);
  FacetedSurface result;
  result.points = mesh.points;
  for (const Region& region : regions) {
    std::vector<FacetPolygon> polygons;
    if (region.size() > 1) {
      polygons = regionPolygons(mesh, context, region, bordersOf(mesh, region, regionOf), labels);
    }
    if (polygons.empty()) {
      for (const Index t : region) polygons.push_back(trianglePolygon(mesh, t, labels));
    }
    std::move(polygons.begin(), polygons.end(), std::back_inserter(result.polygons));
  }
  dropCollinear(result, mesh.fixedPoints, kCollinear * context.diagonal);
  dropUnusedPoints(result);
  return result;
}

}  // namespace phront::facet
