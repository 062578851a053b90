#include "phront/node_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace phront {

Result<void> checkGrid(const NodeGrid& grid) {
  if (*std::min_element(grid.nodes.begin(), grid.nodes.end()) < 1) {
    return fail(ErrorCode::InvalidArgument, "The grid needs at least one node along each axis.",
                "nodes");
  }
  if (!(grid.spacing > 0) || !std::isfinite(grid.spacing)) {
    return fail(
        ErrorCode::InvalidArgument,
        fmt::format("The grid spacing must be positive and finite, not {:g}.", grid.spacing),
        "spacing");
  }
  if (!grid.origin.allFinite()) {
    return fail(ErrorCode::InvalidArgument, "The origin of the grid must be finite.", "origin");
  }
  return {};
}

}  // namespace phront
