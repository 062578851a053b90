// What is solved by all: the distance outside and inside of a sphere in a cube, and bands around
// meshes.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "phront/node_grid.h"

namespace phront::bench {

/// Distance to a sphere of radius 0.3 around the middle of the unit cube, known within a spacing.
struct SphereProblem {
  NodeGrid grid;
  std::vector<double> known;  ///< infinity elsewhere

  explicit SphereProblem(std::int32_t nodes)
      : grid{{nodes, nodes, nodes}, 1.0 / (nodes - 1), Vec3::Zero()} {
    known.reserve(static_cast<std::size_t>(grid.nodeCount()));
    for (std::int32_t k = 0; k < nodes; ++k) {
      for (std::int32_t j = 0; j < nodes; ++j) {
        for (std::int32_t i = 0; i < nodes; ++i) {
          const double d = exact(i, j, k);
          known.push_back(d <= grid.spacing ? d : std::numeric_limits<double>::infinity());
        }
      }
    }
  }
  [[nodiscard]] double signedExact(std::int32_t i, std::int32_t j, std::int32_t k) const {
    return (grid.position(i, j, k) - Vec3::Constant(0.5)).norm() - 0.3;
  }
  [[nodiscard]] double exact(std::int32_t i, std::int32_t j, std::int32_t k) const {
    return std::abs(signedExact(i, j, k));
  }
  /// Largest and root mean square error of times outside the sphere, in spacings.
  struct Error {
    double most = 0;
    double rms = 0;
  };
  [[nodiscard]] Error errorOf(const std::vector<double>& times) const {
    Error error;
    std::size_t n = 0;
    std::size_t outside = 0;
    for (std::int32_t k = 0; k < grid.nodes[2]; ++k) {
      for (std::int32_t j = 0; j < grid.nodes[1]; ++j) {
        for (std::int32_t i = 0; i < grid.nodes[0]; ++i, ++n) {
          const double d = signedExact(i, j, k);
          if (d < 0) continue;
          ++outside;
          const double e = std::abs(times[n] - d) / grid.spacing;
          error.most = std::max(error.most, e);
          error.rms += e * e;
        }
      }
    }
    error.rms = std::sqrt(error.rms / static_cast<double>(outside));
    return error;
  }
};

inline constexpr std::int32_t kSweepNodes = 128;

}  // namespace phront::bench
