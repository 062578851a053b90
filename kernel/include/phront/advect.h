// Advection of points along the gradient of phi: the front of the thesis.
#pragma once

#include <span>
#include <vector>

#include "phront/progress.h"
#include "phront/status.h"
#include "phront/surface_distance.h"

namespace phront {

enum class AdvectStatus : std::uint8_t {
  Arrived,   ///< phi = d to round-off
  Collided,  ///< met another front (medial axis) first; stopped there
  Border,    ///< left an open shell over its border; stopped there
};

struct AdvectOptions {
  double distance = 0;  ///< d, signed, finite, non-zero; positive grows
  int threads = 0;      ///< 0: all cores
};

struct AdvectResult {
  std::vector<Vec3> points;             ///< one per start point, same order
  std::vector<AdvectStatus> status;
  std::vector<double> travelled;        ///< |phi| reached, model units
};

/// Moves each point of the surface (start, with its unit normal towards phi > 0) straight along its
/// normal until phi = d; exact direction (foot points, no grid). Stops where the foot point changes,
/// i.e. at the medial axis, found by bisection to 1e-12 of |d|; on curved faces, where facets of the
/// same smooth face compete, the loss of distance that their turn explains is forgiven.
/// Fails with InvalidArgument (sizes differ; d = 0; NaN or beyond 1e150), Cancelled.
[[nodiscard]] Result<AdvectResult> advectPoints(const SurfaceDistance& surface,
                                                std::span<const Vec3> start,
                                                std::span<const Vec3> normals,
                                                const AdvectOptions& options,
                                                const Progress& progress = {});

/// Moves the nodes of the surface's own mesh; connectivity and order stay as they are. Normals are
/// the angle-weighted pseudonormals; at convex or concave edges, where one direction cannot serve
/// all faces, the node is moved on along the gradient until phi = d.
[[nodiscard]] Result<AdvectResult> advectMesh(const SurfaceDistance& surface,
                                              const AdvectOptions& options,
                                              const Progress& progress = {});

}  // namespace phront
