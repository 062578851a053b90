// Basic types of the kernel. Lengths are in model units: the kernel knows no millimetres.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>

namespace phront {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Box3 = Eigen::AlignedBox3d;

/// Index of a point, triangle or label in a mesh. -1 means "none".
using Index = std::int32_t;
inline constexpr Index kNone = -1;

/// What holds a foot point: the interior of a face, an edge or a vertex.
/// Used both for triangles of a mesh and for features of the B-Rep the mesh stems from.
enum class FeatureKind : std::uint8_t { Face, Edge, Vertex };

/// A feature of the input: B-Rep face, edge or vertex `id`, numbered per kind from 0.
struct Feature {
  FeatureKind kind = FeatureKind::Face;
  Index id = kNone;

  friend bool operator==(const Feature&, const Feature&) = default;
  friend auto operator<=>(const Feature&, const Feature&) = default;
};

}  // namespace phront
