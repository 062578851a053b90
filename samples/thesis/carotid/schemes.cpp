#include "carotid/schemes.h"

#include <cmath>

#include "common/continued.h"
#include "common/report.h"
#include "common/timing.h"
#include "phront/grid_advect.h"
#include "phront/iso_surface.h"

namespace thesis {

using phront::SurfaceDistance;
using phront::TriMesh;
using phront::Vec3;

namespace {

/// Holds the mesh and what lies kWall and two cells around it; continued ends stick out.
phront::NodeGrid gridAround(const TriMesh& mesh, double h) {
  const phront::Box3 box = phront::boundingBox(mesh);
  const Vec3 margin = Vec3::Constant(kWall + 2 * h);
  const Vec3 size = box.sizes() + 2 * margin;
  phront::NodeGrid grid{{}, h, box.min() - margin};
  for (int axis = 0; axis < 3; ++axis) {
    grid.nodes[static_cast<std::size_t>(axis)] =
        static_cast<std::int32_t>(std::ceil(size[axis] / h)) + 1;
  }
  return grid;
}

}  // namespace

Run exactScheme(const TriMesh& mesh) {
  Run run;
  Stopwatch watch;
  const auto surface = orStop(SurfaceDistance::build(mesh));
  run.seed = watch.lap();
  for (std::size_t i = 0; i < kDistances.size(); ++i) {
    run.fronts[i] = orStop(phront::advectMesh(surface, {.distance = kDistances[i], .threads = 1}));
    run.advect[i] = watch.lap();
  }
  return run;
}

Run gridScheme(const TriMesh& mesh, double spacing, Ends ends) {
  Run run;
  run.spacing = spacing;
  run.ends = ends;
  const auto surface =
      orStop(SurfaceDistance::build(ends == Ends::Continued ? continued(mesh, kContinued) : mesh));
  const phront::NodeGrid grid = gridAround(mesh, spacing);
  run.nodes = grid.nodeCount();
  const TimedField timed = sweepTimed(grid, surface);
  run.seed = timed.seed;
  run.sweep = timed.sweep;
  for (std::size_t i = 0; i < kDistances.size(); ++i) {
    const double d = kDistances[i];
    Stopwatch watch;
    (void)orStop(phront::isoSurface(
        surface, {.level = d, .spacing = spacing, .mostRefinedNodes = 0, .threads = 1}));
    run.iso[i] = watch.lap();
    run.fronts[i] = orStop(
        phront::advectOnGrid(grid, timed.field.phi, mesh.points, {.distance = d, .threads = 1}));
    run.advect[i] = watch.lap();
  }
  return run;
}

}  // namespace thesis
