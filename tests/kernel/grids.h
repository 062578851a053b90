// Values on grids whose truth is a function.
#pragma once

#include <vector>

#include "phront/node_grid.h"

namespace phront::test {

/// function(position) at each node, in the order of the nodes.
template <class Function>
std::vector<double> valuesOf(const NodeGrid& grid, const Function& function) {
  std::vector<double> values;
  for (std::int32_t k = 0; k < grid.nodes[2]; ++k) {
    for (std::int32_t j = 0; j < grid.nodes[1]; ++j) {
      for (std::int32_t i = 0; i < grid.nodes[0]; ++i) {
        values.push_back(function(grid.position(i, j, k)));
      }
    }
  }
  return values;
}

}  // namespace phront::test
