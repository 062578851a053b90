// Audit of a distance field at random nodes against distances and signs found otherwise.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "phront/distance_field.h"
#include "reference_distance.h"

namespace phront::test {

/// Random nodes that the field holds, equally likely each, with repetition.
inline std::vector<GridIndex> randomNodes(const DistanceField& field, std::size_t count,
                                          std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<GridIndex> nodes;
  while (nodes.size() < count && !field.tiles().empty()) {
    const auto& tile = field.tiles()[random() % field.tiles().size()];
    const auto n = static_cast<std::int32_t>(random() % DistanceField::kNodesPerTile);
    const GridIndex node{tile.coordinates[0] * 8 + n % 8, tile.coordinates[1] * 8 + n / 8 % 8,
                         tile.coordinates[2] * 8 + n / 64};
    if (field.phi(node)) nodes.push_back(node);
  }
  return nodes;
}

struct FieldAudit {
  double largestError = 0;         ///< of |phi|, model units
  std::int64_t wrongDistance = 0;  ///< nodes whose |phi| is off by more than the tolerance
  std::int64_t wrongSign = 0;
  std::int64_t inside = 0;   ///< nodes with a known sign, in material
  std::int64_t outside = 0;  ///< nodes with a known sign, out of it
};

/// Is x in material? Empty where that is not known.
using InMaterial = std::function<std::optional<bool>(const Vec3&)>;

inline FieldAudit auditField(const DistanceField& field, const std::vector<GridIndex>& nodes,
                             const ReferenceDistance& reference, double tolerance,
                             const InMaterial& inMaterial) {
  FieldAudit audit;
  for (const GridIndex& node : nodes) {
    const Vec3 x = field.position(node);
    const double phi = *field.phi(node);
    const double distance = reference.distance(x);
    const double error = std::abs(std::abs(phi) - distance);
    audit.largestError = std::max(audit.largestError, error);
    audit.wrongDistance += error <= tolerance ? 0 : 1;  // NaN counts as wrong
    if (distance <= tolerance) continue;                // on the surface: no side
    const std::optional<bool> material = inMaterial(x);
    if (!material) continue;
    ++(*material ? audit.inside : audit.outside);
    audit.wrongSign += (phi < 0) == *material ? 0 : 1;
  }
  return audit;
}

}  // namespace phront::test
