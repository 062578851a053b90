// Working mesh of the facetting: triangles that can be collapsed and split in place.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "phront/facet.h"
#include "phront/iso_surface.h"

namespace phront::facet {

using Corners = std::array<Index, 3>;

/// Closed triangle mesh with the triangles around each point at hand. Dead triangles have corner
/// kNone and are kept in place, so that numbers stay valid.
struct WorkMesh {
  std::vector<Vec3> points;
  std::vector<Corners> corners;
  std::vector<Index> label;   ///< per triangle: index into the labels of the iso-surface
  std::vector<Index> plane;   ///< per triangle: offset plane it lies in exactly, or kNone
  std::vector<Index> hint;    ///< per triangle: triangle of the input near the foot of its centroid
  std::vector<Vec3> tangent;  ///< per triangle: gradient of phi at its centroid
  std::vector<std::vector<Index>> around;       ///< per point: its triangles
  std::vector<std::vector<Index>> exactPlanes;  ///< per point: planes it lies on exactly, sorted
  std::vector<Plane> planes;                    ///< offset planes, each once
  Index apexes = 0;       ///< the first points: triangles that use one are no part of the surface
  Index fixedPoints = 0;  ///< the first points, apexes among them, stay where they are

  [[nodiscard]] bool fixed(Index p) const { return p < fixedPoints; }
  [[nodiscard]] bool frozen(Index t) const {
    return alive(t) && (corners[t][0] < apexes || corners[t][1] < apexes || corners[t][2] < apexes);
  }
  [[nodiscard]] Index pointCount() const { return static_cast<Index>(points.size()); }
  [[nodiscard]] Index triangleCount() const { return static_cast<Index>(corners.size()); }
  [[nodiscard]] bool alive(Index t) const { return corners[t][0] != kNone; }
  [[nodiscard]] const Vec3& point(Index t, int corner) const { return points[corners[t][corner]]; }
  [[nodiscard]] Vec3 centroid(Index t) const {
    return (point(t, 0) + point(t, 1) + point(t, 2)) / 3.0;
  }
  /// Normal with the length of twice the area.
  [[nodiscard]] Vec3 areaVector(Index t) const {
    return (point(t, 1) - point(t, 0)).cross(point(t, 2) - point(t, 0));
  }
  /// Corner number of a point in a triangle that holds it.
  [[nodiscard]] int cornerOf(Index t, Index p) const {
    return corners[t][0] == p ? 0 : corners[t][1] == p ? 1 : 2;
  }
  /// The triangle beyond side k (corner k to k+1) of t; kNone on a border.
  [[nodiscard]] Index across(Index t, int side) const;
  [[nodiscard]] Index aliveCount() const;
};

/// Smallest height of a triangle: twice the area over the longest side; 0 when it is a point.
[[nodiscard]] double smallestHeight(const Vec3& a, const Vec3& b, const Vec3& c);

/// Distance of a point from a triangle.
[[nodiscard]] double distanceToTriangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c);

/// What every stage needs to know.
struct Context {
  const SurfaceDistance& surface;
  double level = 0;            ///< d
  double diagonal = 0;         ///< of the iso-surface, the scale of the floors below
  Vec3 center = Vec3::Zero();  ///< of its box
  double heightFloor = 0;      ///< no triangle flatter than this is made
  int threads = 0;
};

/// phi - d with the direction of steepest ascent there.
struct Measured {
  double deviation = 0;  ///< >= 0
  Vec3 gradient = Vec3::Zero();
  Index triangle = kNone;  ///< of the input, holds the foot
};
[[nodiscard]] Measured measure(const Context& context, const Vec3& x, Index hint);

/// The iso-surface as a working mesh, with hints and tangents but without planes.
[[nodiscard]] WorkMesh makeWorkMesh(const Context& context, const IsoSurface& iso);

/// Marks the triangles that lie in the offset plane of their face and moves their points into these
/// planes exactly. Points move by at most `snap`.
void assignPlanes(WorkMesh& mesh, const Context& context, std::span<const Feature> labels,
                  std::span<const std::optional<Plane>> planeOfFace, double snap);

/// Splits sides longer than `shortest` whose middle deviates by more than `tolerance`; new points
/// lie on phi = d.
void refine(WorkMesh& mesh, const Context& context, double tolerance, double shortest,
            Index maxTriangles);

/// Moves points by at most `tolerance` so that phi = d runs between points and facets.
void relax(WorkMesh& mesh, const Context& context, double tolerance);

/// Polygons of the mesh: connected triangles in one plane become one, others stay triangles.
[[nodiscard]] FacetedSurface mergePlanes(const WorkMesh& mesh, const Context& context,
                                         std::span<const Feature> labels);

/// Deviations and non-planarity of `result`, sampled over the triangles it was merged from.
void measureFacets(FacetedSurface& result, const WorkMesh& mesh, const Context& context);

}  // namespace phront::facet
