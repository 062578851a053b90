// Distance to the exact B-Rep, not to its triangles.
#pragma once

#include <TopoDS_Shape.hxx>
#include <memory>

#include "phront/cad/tessellate.h"
#include "phront/surface_distance.h"

namespace phront::cad {

/// The nearest triangles give starting points, Newton on the exact faces, curves and trim borders
/// gives the distance: the tessellation error disappears (round-off, ~1e-9 of the diagonal)
/// wherever the refinement converges to within the chordal error; else the triangles' distance
/// stands. Queries are const but not thread safe (OpenCASCADE adaptors cache).
class TrueDistance {
 public:
  /// `shape` is the shape the tessellation was made from.
  [[nodiscard]] static Result<TrueDistance> build(const TopoDS_Shape& shape,
                                                  Tessellation tessellation);

  struct Foot {
    double distance = 0;        ///< >= 0, to the exact shape
    double meshDistance = 0;    ///< >= 0, to the triangles
    double sign = 1;            ///< of phi, by the triangles' topology
    Vec3 point = Vec3::Zero();  ///< on the exact shape
    Feature feature;            ///< by the trimmed domain: face interior before edge before vertex
    bool beyondBorder = false;  ///< open shells: the foot lies on a free edge
  };
  [[nodiscard]] Foot foot(const Vec3& x) const;
  [[nodiscard]] double signedDistance(const Vec3& x) const;

  [[nodiscard]] const Tessellation& tessellation() const;
  [[nodiscard]] const SurfaceDistance& surface() const;  ///< distance to the triangles

  /// Point and outward unit normal (phi > 0 side) of the exact face under a triangle at barycentric
  /// coordinates; false when the surface is singular there.
  [[nodiscard]] bool pointAndNormal(Index triangle, const Vec3& barycentric, Vec3& point,
                                    Vec3& normal) const;

  TrueDistance(TrueDistance&&) noexcept;
  TrueDistance& operator=(TrueDistance&&) noexcept;
  ~TrueDistance();

 private:
  struct Impl;
  explicit TrueDistance(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace phront::cad
