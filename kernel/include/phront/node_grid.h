// Nodes of a Cartesian grid over a whole domain.
#pragma once

#include <array>
#include <cstdint>

#include "phront/status.h"
#include "phront/types.h"

namespace phront {

/// Node (i,j,k) lies at origin + spacing (i,j,k); nodes are numbered with x fastest.
struct NodeGrid {
  std::array<std::int32_t, 3> nodes{};  ///< per axis, > 0; nodes[2] == 1: a problem in the plane
  double spacing = 0;                   ///< h > 0, model units
  Vec3 origin = Vec3::Zero();

  [[nodiscard]] bool planar() const { return nodes[2] == 1; }
  [[nodiscard]] std::int64_t nodeCount() const {
    return static_cast<std::int64_t>(nodes[0]) * nodes[1] * nodes[2];
  }
  [[nodiscard]] std::int64_t number(std::int32_t i, std::int32_t j, std::int32_t k = 0) const {
    return (static_cast<std::int64_t>(k) * nodes[1] + j) * nodes[0] + i;
  }
  [[nodiscard]] Vec3 position(std::int32_t i, std::int32_t j, std::int32_t k = 0) const {
    return origin + spacing * Vec3(i, j, k);
  }
};

/// InvalidArgument where the grid has no nodes, or its spacing or origin is of no use.
[[nodiscard]] Result<void> checkGrid(const NodeGrid& grid);

}  // namespace phront
