// Signed distance on all nodes of a grid: whole domains, in the plane and in space.
#pragma once

#include <vector>

#include "phront/curve_distance.h"
#include "phront/distance_field.h"
#include "phront/eikonal.h"
#include "phront/progress.h"
#include "phront/status.h"
#include "phront/surface_distance.h"

namespace phront {

struct GridFieldOptions {
  FieldSolver solver = FieldSolver::Exact;
  EikonalOrder order = EikonalOrder::First;  ///< of Godunov
  int threads = 0;                           ///< 0: all cores
};

struct GridField {
  std::vector<double> phi;  ///< per node of the grid, signed: < 0 in material
  std::vector<bool> seed;   ///< Godunov: nodes with an exact value from the start; Exact: empty
  int sweeps = 0;           ///< Godunov
};

/// phi of the curves on a planar grid, or of the surface on one in space. Seeds of Godunov are the
/// nodes of all cells that the geometry may touch: nearer to it than the diagonal of a cell (second
/// order: than that and one cell more). Signs are exact; open geometry: of the side, also beyond
/// the border. Fails with InvalidArgument (grid; Godunov: no node near the geometry), Cancelled.
[[nodiscard]] Result<GridField> solveGridField(const NodeGrid& grid, const CurveDistance& curves,
                                               const GridFieldOptions& options = {},
                                               const Progress& progress = {});
[[nodiscard]] Result<GridField> solveGridField(const NodeGrid& grid, const SurfaceDistance& surface,
                                               const GridFieldOptions& options = {},
                                               const Progress& progress = {});

}  // namespace phront
