// Labelled triangle mesh: what every surface becomes before the field sees it.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "phront/status.h"
#include "phront/types.h"

namespace phront {

/// Triangles over shared points. Seen from outside (phi > 0) corners run counter-clockwise.
/// The three label arrays say which B-Rep feature a mesh element stems from; an empty array means
/// "no labels": every triangle then belongs to face 0, no edge and no vertex is a feature.
struct TriMesh {
  std::vector<Vec3> points;                     ///< n points, model units
  std::vector<std::array<Index, 3>> triangles;  ///< m triangles, indices into `points`
  std::vector<Index> faceOf;                    ///< m, B-Rep face of each triangle
  std::vector<Index> edgeOf;    ///< 3m, side k of triangle t (corner k to k+1): B-Rep edge or kNone
  std::vector<Index> vertexOf;  ///< n, B-Rep vertex at each point or kNone

  [[nodiscard]] Index face(Index triangle) const {
    return faceOf.empty() ? 0 : faceOf[static_cast<std::size_t>(triangle)];
  }
};

/// Bounding box; empty box for a mesh without points.
[[nodiscard]] Box3 boundingBox(const TriMesh& mesh);

/// Signed volume enclosed by a closed mesh, positive when oriented outward (model units cubed).
[[nodiscard]] double signedVolume(const TriMesh& mesh);

/// Total area (model units squared).
[[nodiscard]] double area(const TriMesh& mesh);

/// What is wrong with a mesh, counted.
struct MeshDiagnostics {
  Index nonFinitePoints = 0;      ///< NaN or infinite coordinates
  Index badIndices = 0;           ///< triangles that name a point which is not there
  Index degenerateTriangles = 0;  ///< a point used twice, or zero area
  Index freeEdges = 0;            ///< used by one triangle
  Index nonManifoldEdges = 0;     ///< used by more than two triangles
  Index misorientedEdges = 0;     ///< run twice in the same direction
  Index nonManifoldPoints = 0;    ///< whose triangles form more than one fan
  Index components = 0;           ///< pieces connected over edges

  /// Closed, consistently oriented 2-manifold.
  [[nodiscard]] bool closedManifold() const {
    return nonFinitePoints == 0 && badIndices == 0 && freeEdges == 0 && nonManifoldEdges == 0 &&
           misorientedEdges == 0 && nonManifoldPoints == 0 && components > 0;
  }
};
[[nodiscard]] MeshDiagnostics diagnose(const TriMesh& mesh);

/// Component number of each triangle (connected over shared edges), numbered in order of the first
/// triangle; `count` components.
struct Components {
  std::vector<Index> ofTriangle;
  Index count = 0;
};
[[nodiscard]] Components connectedComponents(const TriMesh& mesh);

struct OrientedMesh {
  TriMesh mesh;
  Index turned = 0;  ///< triangles whose corners were reversed
};
/// Reverses triangles until neighbours agree about their outside, that is, run the edge they share
/// in opposite directions. In each part connected over edges of two triangles the orientation that
/// covers more area stays; a part that is inside out altogether stays so. One-sided surfaces keep
/// edges whose triangles disagree, and edges of more than two triangles decide nothing: diagnose()
/// tells. Indices must be in range. Labels follow.
[[nodiscard]] OrientedMesh orient(TriMesh mesh);

/// Merges bitwise equal points (STL stores each triangle's corners anew), keeps triangle order and
/// labels; drops triangles that collapse. Order of points: first use.
[[nodiscard]] TriMesh weld(const TriMesh& mesh);

}  // namespace phront
