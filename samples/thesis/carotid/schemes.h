// The two ways to move the points of a vessel's wall, with the times they take.
#pragma once

#include <array>
#include <cstdint>

#include "phront/advect.h"
#include "phront/tri_mesh.h"

namespace thesis {

inline constexpr double kWall = 0.5;    // mm, outwards: the thickness of the vessel's wall
inline constexpr double kLayer = -0.3;  // mm, inwards: a boundary layer
inline constexpr std::array<double, 2> kDistances{kWall, kLayer};

/// How the field sees the ends of the vessel.
enum class Ends {
  Free,       ///< as they are: the field bends round the border
  Continued,  ///< longer by kContinued and closed
};
inline constexpr double kContinued = 1.5;  // mm: no point comes as near to a lid as to the wall

/// Seconds on one thread.
struct Run {
  double spacing = 0;      ///< of the grid, mm; 0: exact scheme
  Ends ends = Ends::Free;  ///< the exact scheme knows no others
  std::int64_t nodes = 0;
  double seed = 0;  ///< exact distances near the wall; exact scheme: the tree of triangles
  double sweep = 0;
  // For each of kDistances:
  std::array<double, 2> iso{};  ///< isoSurface() at the same spacing, from exact values of its own
  std::array<double, 2> advect{};
  std::array<phront::AdvectResult, 2> fronts;
};

[[nodiscard]] Run exactScheme(const phront::TriMesh& mesh);
[[nodiscard]] Run gridScheme(const phront::TriMesh& mesh, double spacing, Ends ends);

}  // namespace thesis
