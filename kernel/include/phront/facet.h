// An iso-surface as few planar facets: what becomes a solid when exact patches fail.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "phront/iso_surface.h"
#include "phront/status.h"

namespace phront {

/// n . x = offset, |n| = 1.
struct Plane {
  Vec3 normal = Vec3::UnitZ();
  double offset = 0;
};

struct FacetOptions {
  double tolerance = 0;      ///< allowed deviation of facets from phi = d, model units, > 0
  Index maxFacets = 20'000;  ///< tolerance is raised (and reported) until this holds
  /// Per B-Rep face of the input: its plane if it is planar, in the input's position.
  /// The offset plane of face f is {normal, offset + d} with the normal towards phi > 0.
  std::vector<std::optional<Plane>> planeOfFace;
  int threads = 0;
};

/// A planar polygon. loops[0] is the outer loop, counter-clockwise around `plane.normal`, which
/// points out of the solid; further loops are holes, clockwise. No loop visits a point twice.
struct FacetPolygon {
  Feature feature;  ///< whose offset this is
  Plane plane;
  std::vector<std::vector<Index>> loops;
};

/// Closed polygonal surface: every directed side is used once in each direction.
struct FacetedSurface {
  std::vector<Vec3> points;
  std::vector<FacetPolygon> polygons;
  double maxDeviation = 0;     ///< measured max |phi - d| on a sample of all facets
  double p99Deviation = 0;     ///< 99th percentile by area of the same
  double maxNonPlanarity = 0;  ///< largest distance of a point from the plane of its polygon
};

/// Openings of a surface that follows phi = d elsewhere.
struct SurfaceHoles {
  /// Per hole its loops of corners, with straight sides between them; the hole lies on their left,
  /// seen from phi > d. Each corner once.
  std::vector<std::vector<std::vector<Vec3>>> loops;
  const SurfaceDistance& around;  ///< the surface that has the holes, as triangles
  double margin = 0;  ///< > 0: so near to `around` the front gives way to triangles between them
};

/// Collapses edges (quadric error, Garland & Heckbert 1997; labels and creases kept), merges each
/// plane-labelled region into one polygon, leaves triangles elsewhere.
/// Fails with InvalidArgument, Failed (no closed result within maxFacets), Cancelled.
[[nodiscard]] Result<FacetedSurface> facetIsoSurface(const SurfaceDistance& surface,
                                                     const IsoSurface& iso, double level,
                                                     const FacetOptions& options,
                                                     const Progress& progress = {});

/// Facets of the part of phi = d that fills the holes: what of the front lies farther than the
/// margin from the surface around them, and what joins it to their corners (least area, see
/// leastAreaTriangles()). The result's first points are the corners in the order given; each side
/// of a loop is used once, along the loop. Whole components of the front far from that surface are
/// filled in, too. Fails as facetIsoSurface() and with ResourceLimit (a hole of too many corners).
[[nodiscard]] Result<FacetedSurface> facetHoles(const SurfaceDistance& surface,
                                                const IsoSurface& iso, double level,
                                                const SurfaceHoles& holes,
                                                const FacetOptions& options,
                                                const Progress& progress = {});

/// Facets of the front on one side of an open surface: what of phi = d has its foot within `sheet`
/// or straight over a free edge. `around`: the same mesh with SignRule::Unsigned; `wrap`: its
/// iso-surface at |d|. The polygons look to where the sheet's outer side looks, for d < 0 as well;
/// sides over free edges are used once. No polygons where nothing of the front is left there.
/// Fails as facetIsoSurface().
[[nodiscard]] Result<FacetedSurface> facetSheet(const SurfaceDistance& sheet,
                                                const SurfaceDistance& around,
                                                const IsoSurface& wrap, double distance,
                                                const FacetOptions& options,
                                                const Progress& progress = {});

}  // namespace phront
