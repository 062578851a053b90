// Meshes and spacings that bands are computed for.
#pragma once

#include <string>
#include <vector>

#include "phront/surface_distance.h"

namespace phront::bench {

struct BandProblem {
  std::string name;
  TriMesh mesh;
  double h = 0;
  bool isSphere = false;
};

/// A sphere of 20k triangles, a torus of 500k, and the first bodies of the parts that
/// PHRONT_BENCH_PARTS names (split by colons). h is 1/200 of the largest side.
[[nodiscard]] const std::vector<BandProblem>& bandProblems();

}  // namespace phront::bench
