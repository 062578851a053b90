// Planar polygons to a B-Rep, built from below: vertices, straight edges, wires, planar faces,
// shells, solids. Nothing is sewn or intersected: every undirected side becomes one edge, used
// forward by one face and reversed by the other, so the shells are closed by construction.
//
// Shells with positive volume bound solids; those with negative volume are cavities of the smallest
// positive shell around them, found by the solid angle under which a point of the cavity sees the
// shell (van Oosterom & Strackee 1983).
#include "rebuild/facet_solid.h"

#include <BRep_Builder.hxx>
#include <Geom_Line.hxx>
#include <Geom_Plane.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>

#include "exchange/guard.h"

namespace phront::cad {

namespace {

// Tolerances exceed the distances they cover by this factor: checks compare with round-off.
constexpr double kToleranceMargin = 1.5;

using Loop = std::vector<Index>;

gp_Pnt toPnt(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

/// One undirected side with the polygons on its two directions.
struct Side {
  Index from = kNone;
  Index to = kNone;
  Index forward = kNone;  ///< polygon that runs from -> to
  Index backward = kNone;
  double tolerance = 0;
  TopoDS_Edge edge = {};  ///< oriented from -> to
};

/// Sides in the order of their first use, and where each polygon finds its own.
struct Sides {
  std::vector<Side> all;
  std::map<std::pair<Index, Index>, Index> number;  ///< by (smaller, larger) point

  [[nodiscard]] Index find(Index a, Index b) const {
    return number.at({std::min(a, b), std::max(a, b)});
  }
};

using Borders = std::vector<std::vector<TopoDS_Edge>>;

/// The sides of the borders, with their edges.
Sides sidesOf(const Borders& borders) {
  Sides sides;
  Index first = 0;
  for (const std::vector<TopoDS_Edge>& loop : borders) {
    const auto count = static_cast<Index>(loop.size());
    for (Index k = 0; k < count; ++k) {
      const Index a = first + k;
      const Index b = first + (k + 1) % count;
      sides.number[{std::min(a, b), std::max(a, b)}] = static_cast<Index>(sides.all.size());
      sides.all.push_back({.from = a, .to = b, .edge = loop[static_cast<std::size_t>(k)]});
    }
    first += count;
  }
  return sides;
}

Result<void> checkPolygons(const FacetedSurface& facets) {
  if (facets.polygons.empty()) return fail(ErrorCode::Failed, "There are no facets.");
  for (const FacetPolygon& polygon : facets.polygons) {
    if (polygon.loops.empty()) return fail(ErrorCode::Failed, "A facet has no outer loop.");
  }
  return {};
}

Result<Sides> pairSides(const FacetedSurface& facets, const Borders& borders) {
  Sides sides = sidesOf(borders);
  const auto pointCount = static_cast<Index>(facets.points.size());
  for (std::size_t i = 0; i < facets.polygons.size(); ++i) {
    for (const Loop& loop : facets.polygons[i].loops) {
      if (loop.size() < 3) {
        return fail(ErrorCode::Failed, "A facet has a loop of fewer than three points.");
      }
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const Index a = loop[k];
        const Index b = loop[(k + 1) % loop.size()];
        if (a == b || std::min(a, b) < 0 || std::max(a, b) >= pointCount) {
          return fail(ErrorCode::Failed, "A facet names a point that is not there.");
        }
        const auto [at, isNew] = sides.number.try_emplace({std::min(a, b), std::max(a, b)},
                                                          static_cast<Index>(sides.all.size()));
        if (isNew) sides.all.push_back({.from = a, .to = b});
        Side& side = sides.all[at->second];
        Index& use = side.from == a ? side.forward : side.backward;
        if (use != kNone) {
          return fail(ErrorCode::Failed, "Facets do not close: a side is used twice one way.");
        }
        use = static_cast<Index>(i);
      }
    }
  }
  return sides;
}

/// Only the borders' sides are used by one facet.
Result<Sides> closedSides(const FacetedSurface& facets, const Borders& borders) {
  Result<Sides> sides = pairSides(facets, borders);
  if (!sides) return sides;
  for (const Side& side : sides->all) {
    const bool atBorder = !side.edge.IsNull();
    if (side.forward == kNone || (side.backward == kNone) != atBorder) {
      return fail(ErrorCode::Failed, "Facets do not close: a side is used by one facet only.");
    }
  }
  return sides;
}

double offPlane(const Plane& plane, const Vec3& p) {
  return std::abs(plane.normal.dot(p) - plane.offset);
}

/// Vertices and edges with tolerances that cover their distance to the planes around.
void makeEdges(const FacetedSurface& facets, Sides& sides) {
  const BRep_Builder builder;
  std::vector<double> tolerance(facets.points.size(), Precision::Confusion());
  for (Side& side : sides.all) {
    double off = 0;
    for (const Index polygon : {side.forward, side.backward}) {
      if (polygon == kNone) continue;
      const Plane& plane = facets.polygons[polygon].plane;
      for (const Index p : {side.from, side.to}) {
        off = std::max(off, offPlane(plane, facets.points[p]));
      }
    }
    side.tolerance = std::max(Precision::Confusion(), kToleranceMargin * off);
    for (const Index p : {side.from, side.to}) {
      tolerance[p] = std::max(tolerance[p], side.tolerance);
    }
  }
  std::vector<TopoDS_Vertex> vertices(facets.points.size());
  const auto vertexAt = [&](Index p) -> const TopoDS_Vertex& {
    if (vertices[p].IsNull())
      builder.MakeVertex(vertices[p], toPnt(facets.points[p]), tolerance[p]);
    return vertices[p];
  };
  for (const Side& side : sides.all) {
    if (!side.edge.IsNull()) vertices[side.from] = TopExp::FirstVertex(side.edge, Standard_True);
  }
  for (Side& side : sides.all) {
    if (!side.edge.IsNull()) continue;
    const gp_Pnt a = toPnt(facets.points[side.from]);
    const gp_Pnt b = toPnt(facets.points[side.to]);
    const Handle(Geom_Line) line = new Geom_Line(a, gp_Dir(gp_Vec(a, b)));
    builder.MakeEdge(side.edge, line, side.tolerance);
    builder.Add(side.edge, vertexAt(side.from).Oriented(TopAbs_FORWARD));
    builder.Add(side.edge, vertexAt(side.to).Oriented(TopAbs_REVERSED));
    builder.Range(side.edge, 0, a.Distance(b));
  }
}

TopoDS_Face makeFace(const FacetPolygon& polygon, const FacetedSurface& facets,
                     const Sides& sides) {
  const BRep_Builder builder;
  const Vec3& first = facets.points[polygon.loops[0][0]];
  const Vec3 n = polygon.plane.normal;
  const Vec3 at = first - (n.dot(first) - polygon.plane.offset) * n;
  TopoDS_Face face;
  builder.MakeFace(face, new Geom_Plane(toPnt(at), gp_Dir(n.x(), n.y(), n.z())),
                   Precision::Confusion());
  for (const Loop& loop : polygon.loops) {
    TopoDS_Wire wire;
    builder.MakeWire(wire);
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Index b = loop[(k + 1) % loop.size()];
      const Side& side = sides.all[sides.find(loop[k], b)];
      builder.Add(wire, side.to == b ? TopoDS_Shape(side.edge) : side.edge.Reversed());
    }
    wire.Closed(true);
    builder.Add(face, wire);
  }
  return face;
}

/// Calls visit(a, b, c) for the triangles of a fan over each loop: together they bound what the
/// polygons bound, with parts outside non-convex loops counted both ways.
template <class Visit>
void forFans(const FacetedSurface& facets, const std::vector<Index>& polygons, Visit&& visit) {
  for (const Index i : polygons) {
    for (const Loop& loop : facets.polygons[i].loops) {
      for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
        visit(facets.points[loop[0]], facets.points[loop[k]], facets.points[loop[k + 1]]);
      }
    }
  }
}

double areaOf(const FacetedSurface& facets, Index polygon) {
  Vec3 twice = Vec3::Zero();
  forFans(facets, {polygon},
          [&](const Vec3& a, const Vec3& b, const Vec3& c) { twice += (b - a).cross(c - a); });
  return twice.norm() / 2;
}

/// The polygons of each shell, the largest first: readers ask it which side of the shell is inside.
/// Each of the others follows one that it shares a side with: readers that put shells together face
/// by face need one pass then, and one for every few faces in any other order.
std::vector<std::vector<Index>> shellsOf(const FacetedSurface& facets, const Sides& sides) {
  const std::size_t count = facets.polygons.size();
  std::vector<double> areas;
  for (std::size_t i = 0; i < count; ++i) areas.push_back(areaOf(facets, static_cast<Index>(i)));
  std::vector<std::size_t> bySize(count);
  std::iota(bySize.begin(), bySize.end(), std::size_t{0});
  std::ranges::stable_sort(bySize, std::ranges::greater{}, [&](std::size_t i) { return areas[i]; });
  std::vector<std::vector<Index>> beside(count);
  for (const Side& side : sides.all) {
    if (side.backward == kNone) continue;
    beside[static_cast<std::size_t>(side.forward)].push_back(side.backward);
    beside[static_cast<std::size_t>(side.backward)].push_back(side.forward);
  }
  std::vector<std::vector<Index>> shells;
  std::vector<char> taken(count, 0);
  for (const std::size_t i : bySize) {
    if (taken[i] != 0) continue;
    std::vector<Index> shell{static_cast<Index>(i)};
    taken[i] = 1;
    for (std::size_t at = 0; at < shell.size(); ++at) {
      for (const Index next : beside[static_cast<std::size_t>(shell[at])]) {
        if (taken[static_cast<std::size_t>(next)] != 0) continue;
        taken[static_cast<std::size_t>(next)] = 1;
        shell.push_back(next);
      }
    }
    shells.push_back(std::move(shell));
  }
  return shells;
}

struct Extent {
  double volume = 0;
  double area = 0;  // at least that of the polygons
};

Extent extentOf(const FacetedSurface& facets, const std::vector<Index>& polygons,
                const Vec3& origin) {
  Extent extent;
  forFans(facets, polygons, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    extent.volume += (a - origin).dot((b - origin).cross(c - origin)) / 6;
    extent.area += (b - a).cross(c - a).norm() / 2;
  });
  return extent;
}

bool surrounds(const FacetedSurface& facets, const std::vector<Index>& polygons, const Vec3& x) {
  double angle = 0;
  forFans(facets, polygons, [&](const Vec3& pa, const Vec3& pb, const Vec3& pc) {
    const Vec3 a = pa - x;
    const Vec3 b = pb - x;
    const Vec3 c = pc - x;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)),
                            la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  });
  return angle > 2 * std::numbers::pi;  // 4 pi inside, 0 outside
}

/// For each shell the shell whose solid it belongs to: itself when positive; kNone when nothing
/// surrounds a cavity.
std::vector<Index> ownersOf(const FacetedSurface& facets,
                            const std::vector<std::vector<Index>>& shells,
                            const std::vector<Extent>& extents) {
  std::vector<Index> owners(shells.size(), kNone);
  for (std::size_t s = 0; s < shells.size(); ++s) {
    if (extents[s].volume > 0) {
      owners[s] = static_cast<Index>(s);
      continue;
    }
    const Vec3& inside = facets.points[facets.polygons[shells[s].front()].loops[0][0]];
    double smallest = std::numeric_limits<double>::infinity();
    for (std::size_t o = 0; o < shells.size(); ++o) {
      if (extents[o].volume <= -extents[s].volume || extents[o].volume >= smallest) continue;
      if (!surrounds(facets, shells[o], inside)) continue;
      smallest = extents[o].volume;
      owners[s] = static_cast<Index>(o);
    }
  }
  return owners;
}

TopoDS_Shell makeShell(const FacetedSurface& facets, const std::vector<Index>& polygons,
                       const Sides& sides, bool closed) {
  const BRep_Builder builder;
  TopoDS_Shell shell;
  builder.MakeShell(shell);
  for (const Index i : polygons) builder.Add(shell, makeFace(facets.polygons[i], facets, sides));
  shell.Closed(closed);
  return shell;
}

Result<TopoDS_Shape> buildSheet(const FacetedSurface& facets) {
  if (Result<void> ok = checkPolygons(facets); !ok) return tl::unexpected<Error>(ok.error());
  Result<Sides> sides = pairSides(facets, {});
  if (!sides) return tl::unexpected<Error>(sides.error());
  makeEdges(facets, *sides);
  const BRep_Builder builder;
  TopoDS_Compound compound;
  builder.MakeCompound(compound);
  const std::vector<std::vector<Index>> shells = shellsOf(facets, *sides);
  for (const std::vector<Index>& polygons : shells) {
    const TopoDS_Shell shell = makeShell(facets, polygons, *sides, false);
    if (shells.size() == 1) return TopoDS_Shape(shell);
    builder.Add(compound, shell);
  }
  return TopoDS_Shape(compound);
}

Result<TopoDS_Shape> buildSolid(const FacetedSurface& facets) {
  if (Result<void> ok = checkPolygons(facets); !ok) return tl::unexpected<Error>(ok.error());
  Result<Sides> sides = closedSides(facets, {});
  if (!sides) return tl::unexpected<Error>(sides.error());
  makeEdges(facets, *sides);

  const std::vector<std::vector<Index>> shells = shellsOf(facets, *sides);
  std::vector<Extent> extents;
  for (const auto& shell : shells) {
    extents.push_back(extentOf(facets, shell, facets.points.front()));
  }
  const std::vector<Index> owners = ownersOf(facets, shells, extents);

  const BRep_Builder builder;
  std::vector<TopoDS_Solid> solids(shells.size());
  for (std::size_t s = 0; s < shells.size(); ++s) {  // the outer shell comes first in a solid
    if (owners[s] != static_cast<Index>(s)) continue;
    builder.MakeSolid(solids[s]);
    builder.Add(solids[s], makeShell(facets, shells[s], *sides, true));
  }
  for (std::size_t s = 0; s < shells.size(); ++s) {
    if (owners[s] == static_cast<Index>(s)) continue;
    if (owners[s] == kNone) {
      // A crumb of material so thin that its sides, each as far off as facets may be, have passed
      // one another.
      if (-extents[s].volume <= facets.maxDeviation * extents[s].area) continue;
      return fail(ErrorCode::Failed, "Facets close around empty space outside every solid.");
    }
    builder.Add(solids[owners[s]], makeShell(facets, shells[s], *sides, true));
  }
  std::erase_if(solids, [](const TopoDS_Solid& solid) { return solid.IsNull(); });
  if (solids.empty()) return fail(ErrorCode::Failed, "Facets close around nothing.");
  if (solids.size() == 1) return TopoDS_Shape(solids.front());
  TopoDS_Compound compound;
  builder.MakeCompound(compound);
  for (const TopoDS_Solid& solid : solids) builder.Add(compound, solid);
  return TopoDS_Shape(compound);
}

}  // namespace

Result<TopoDS_Shape> solidOfFacets(const FacetedSurface& facets) {
  return guardOcct("building a solid of planar facets",
                   [&]() -> Result<TopoDS_Shape> { return buildSolid(facets); });
}

Result<TopoDS_Shape> sheetOfFacets(const FacetedSurface& facets) {
  return guardOcct("building a sheet of planar facets",
                   [&]() -> Result<TopoDS_Shape> { return buildSheet(facets); });
}

Result<std::vector<TopoDS_Face>> facesOfFacets(const FacetedSurface& facets,
                                               const Borders& borders) {
  Result<Sides> sides = closedSides(facets, borders);
  if (!sides) return tl::unexpected<Error>(sides.error());
  makeEdges(facets, *sides);
  std::vector<TopoDS_Face> faces;
  for (const FacetPolygon& polygon : facets.polygons)
    faces.push_back(makeFace(polygon, facets, *sides));
  return faces;
}

}  // namespace phront::cad
