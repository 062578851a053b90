// The front phi = d as a closed, labelled triangle mesh.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "phront/progress.h"
#include "phront/status.h"
#include "phront/surface_distance.h"

namespace phront {

struct IsoSurfaceOptions {
  double level = 0;                              ///< d, signed; positive lies outside material
  std::optional<double> spacing = std::nullopt;  ///< grid spacing h; automatic: fine enough for
                                                 ///< |d| and the box
  /// The automatic spacing is no larger than this, model units: what chords may cut.
  double largestSpacing = std::numeric_limits<double>::infinity();
  /// The automatic spacing spreads no more squares than this over the surface's area, whatever |d|
  /// asks for: work grows with area / h^2. largestSpacing goes first.
  double mostSquares = std::numeric_limits<double>::infinity();
  /// Cells at creases are halved where triangles miss the level by more than this, model units.
  double creaseTolerance = std::numeric_limits<double>::infinity();
  /// Cells are halved, there and around features thinner than they are, as long as the grid has
  /// fewer nodes than this: about 3 microseconds each. Whatever it says, the first grid is made.
  std::int64_t mostRefinedNodes = 12'000'000;
  int threads = 0;  ///< 0: all cores
};

/// phi = d. Closed 2-manifold for a closed input, oriented towards larger phi for d > 0 as well as
/// d < 0 (outward of the grown or shrunk solid). Empty (no triangles) when no point has phi = d.
struct IsoSurface {
  TriMesh mesh;                     ///< faceOf: index into `labels` of each triangle
  std::vector<Feature> labels;      ///< features of the input that occur, sorted
  std::vector<Index> labelOfPoint;  ///< label (into `labels`) of each point's foot
  double spacing = 0;               ///< h of the grid
  double finestSpacing = 0;         ///< of its smallest cells, around thin features
  double maxResidual = 0;           ///< measured max |phi - d| over the points
  bool refined = false;             ///< cells were halved
  bool unresolved = false;          ///< features thinner than the cells were met and left out
};

/// Extracts phi = d from tiles around the level, places points on creases where feet of different
/// features meet, projects each point to |phi - d| <= 1e-9 diag against the mesh.
/// Same input, same bits at any thread count.
/// Cancelled while it refines for thin features: gives the surface it has, unresolved.
/// Fails with InvalidArgument, ResourceLimit, Cancelled.
[[nodiscard]] Result<IsoSurface> isoSurface(const SurfaceDistance& surface,
                                            const IsoSurfaceOptions& options,
                                            const Progress& progress = {});

}  // namespace phront
