// Facetting of phi = d: refine where the iso-surface is coarse, put plane regions into their
// planes, collapse within the tolerance, let points float, merge planes into polygons, measure.
//
// Each stage keeps the surface closed, so whatever the deviation, the result bounds a solid. When
// the facets are too many the tolerance grows until they are not; the measured deviation tells.
#include "phront/facet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "front/facet_collapse.h"
#include "front/facet_mesh.h"
#include "front/facet_tidy.h"
#include "front/hole_patch.h"
#include "front/sheet_side.h"

namespace phront {

namespace {

// Share of the tolerance that points may move to enter their planes.
constexpr double kSnapShare = 0.1;
// Flattest triangle that is made, of the diagonal: well above OpenCASCADE's 1e-7 mm for parts of a
// few mm, well below any tolerance.
constexpr double kHeightFloor = 1e-7;
// Sides are split where they deviate by more than this share of the tolerance: the collapse needs
// the rest.
constexpr double kRefineShare = 0.8;
// Triangles that splitting may add: enough for any sound iso-surface, an end to unsound ones.
constexpr Index kMaxAdded = 150'000;
// Sides shorter than this share of the grid spacing are not split: three halvings take a chord's
// deviation down to 1/64, what is left then is a missed crease.
constexpr double kShortestOfSpacing = 0.12;
constexpr double kToleranceStep = 1.5;
constexpr int kMaxRounds = 24;  // 1.5^24 = 17 000 times the tolerance

Result<void> validate(const SurfaceDistance& surface, const IsoSurface& iso, double level,
                      const FacetOptions& options) {
  if (!std::isfinite(level)) return fail(ErrorCode::InvalidArgument, "The level is not finite.");
  if (!(options.tolerance > 0) || !std::isfinite(options.tolerance)) {
    return fail(ErrorCode::InvalidArgument, "FacetOptions.tolerance must be positive and finite.");
  }
  if (options.maxFacets < 4) {
    return fail(ErrorCode::InvalidArgument, "FacetOptions.maxFacets must be at least 4.");
  }
  if (!surface.closed()) {
    return fail(ErrorCode::InvalidArgument, "Facets need the distance to a closed surface.");
  }
  for (const Index label : iso.mesh.faceOf) {
    if (label < 0 || static_cast<std::size_t>(label) >= iso.labels.size()) {
      return fail(ErrorCode::InvalidArgument, "A triangle of the iso-surface has no label.");
    }
  }
  const MeshDiagnostics found = diagnose(iso.mesh);
  if (!found.closedManifold()) {
    return fail(
        ErrorCode::Failed,
        fmt::format("The iso-surface is no closed manifold: {} free, {} non-manifold and {} "
                    "misoriented edges, {} non-manifold points.",
                    found.freeEdges, found.nonManifoldEdges, found.misorientedEdges,
                    found.nonManifoldPoints));
  }
  return {};
}

/// Triangles outside planes: facets for certain, a lower bound of all.
Index countFacets(const facet::WorkMesh& mesh) {
  Index count = 0;
  for (Index t = 0; t < mesh.triangleCount(); ++t) {
    if (mesh.alive(t) && !mesh.frozen(t) && mesh.plane[t] == kNone) ++count;
  }
  return count;
}

/// `box` of the whole front. The first points of `iso` are apexes and fixed points of the mesh.
Result<FacetedSurface> facets(const SurfaceDistance& surface, const IsoSurface& iso,
                              const Box3& box, Index apexes, Index fixedPoints, double level,
                              const FacetOptions& options, const Progress& progress) {
  const double diagonal = box.diagonal().norm();
  const facet::Context context{.surface = surface,
                               .level = level,
                               .diagonal = diagonal,
                               .center = box.center(),
                               .heightFloor = kHeightFloor * diagonal,
                               .threads = options.threads};
  const std::vector<Feature> labels =
      iso.mesh.faceOf.empty() ? std::vector<Feature>{Feature{FeatureKind::Face, 0}} : iso.labels;

  facet::WorkMesh mesh = facet::makeWorkMesh(context, iso);
  mesh.apexes = apexes;
  mesh.fixedPoints = fixedPoints;
  if (!progress.report(0.1)) return fail(ErrorCode::Cancelled, "Facetting was cancelled.");
  facet::assignPlanes(mesh, context, labels, options.planeOfFace, kSnapShare * options.tolerance);
  facet::refine(mesh, context, kRefineShare * options.tolerance, kShortestOfSpacing * iso.spacing,
                mesh.triangleCount() + kMaxAdded);
  if (!progress.report(0.3)) return fail(ErrorCode::Cancelled, "Facetting was cancelled.");

  facet::Collapser collapser(mesh, context);
  double tolerance = options.tolerance;
  for (int round = 0; round < kMaxRounds; ++round, tolerance *= kToleranceStep) {
    const auto collapsed = collapser.run(tolerance, progress.part(round == 0 ? 0.3 : 0.8, 0.9));
    if (!collapsed) return tl::unexpected<Error>(collapsed.error());
    if (countFacets(mesh) > options.maxFacets) continue;
    facet::relax(mesh, context, tolerance);
    FacetedSurface result = facet::mergePlanes(mesh, context, labels);
    facet::tidyFacets(result, context.heightFloor);
    if (static_cast<std::size_t>(options.maxFacets) < result.polygons.size()) continue;
    facet::measureFacets(result, mesh, context);
    return result;
  }
  return fail(ErrorCode::Failed,
              fmt::format("More than {} facets are left even at {:.3g} times the tolerance.",
                          options.maxFacets, tolerance / options.tolerance));
}

Plane turned(const Plane& plane) { return {-plane.normal, -plane.offset}; }

}  // namespace

Result<FacetedSurface> facetIsoSurface(const SurfaceDistance& surface, const IsoSurface& iso,
                                       double level, const FacetOptions& options,
                                       const Progress& progress) {
  if (iso.mesh.triangles.empty()) return FacetedSurface{};
  if (const auto ok = validate(surface, iso, level, options); !ok) {
    return tl::unexpected<Error>(ok.error());
  }
  return facets(surface, iso, boundingBox(iso.mesh), 0, 0, level, options, progress);
}

Result<FacetedSurface> facetHoles(const SurfaceDistance& surface, const IsoSurface& iso,
                                  double level, const SurfaceHoles& holes,
                                  const FacetOptions& options, const Progress& progress) {
  const Result<facet::CappedFront> patch = facet::makeHolePatch(surface, iso, holes);
  if (!patch) return tl::unexpected<Error>(patch.error());
  if (const auto ok = validate(surface, patch->iso, level, options); !ok) {
    return tl::unexpected<Error>(ok.error());
  }
  const Box3 box = boundingBox(iso.mesh).merged(boundingBox(patch->iso.mesh));
  return facets(surface, patch->iso, box, patch->apexes, patch->fixedPoints, level, options,
                progress);
}

Result<FacetedSurface> facetSheet(const SurfaceDistance& sheet, const SurfaceDistance& around,
                                  const IsoSurface& wrap, double distance,
                                  const FacetOptions& options, const Progress& progress) {
  if (wrap.mesh.triangles.empty()) return FacetedSurface{};
  const double level = std::abs(distance);
  if (const auto ok = validate(around, wrap, level, options); !ok) {
    return tl::unexpected<Error>(ok.error());
  }
  const facet::CappedFront front =
      facet::frontBesideSheet(sheet, wrap, distance, options.tolerance);
  if (front.iso.mesh.triangles.empty()) return FacetedSurface{};
  FacetOptions beside = options;
  if (distance < 0) {  // seen from that side
    for (std::optional<Plane>& plane : beside.planeOfFace)
      if (plane) plane = turned(*plane);
  }
  Result<FacetedSurface> made = facets(around, front.iso, boundingBox(front.iso.mesh), front.apexes,
                                       front.fixedPoints, level, beside, progress);
  if (!made || distance > 0) return made;
  for (FacetPolygon& polygon : made->polygons) {
    polygon.plane = turned(polygon.plane);
    for (std::vector<Index>& loop : polygon.loops) std::reverse(loop.begin(), loop.end());
  }
  return made;
}

}  // namespace phront
