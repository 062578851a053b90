// One B-Rep face as a surface in space: points, outward normals, foot points. Not trimmed.
#pragma once

#include <BRepAdaptor_Surface.hxx>
#include <TopoDS_Face.hxx>

#include "phront/cad/tessellate.h"

namespace phront::cad {

/// A closest point of an untrimmed surface.
struct SurfaceFoot {
  bool converged = false;
  bool atBound = false;  ///< held back by a bound of the surface: x does not lie along the normal
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();
  Vec3 point = Vec3::Zero();
};

/// Evaluates with OpenCASCADE adaptors, which cache: one object per thread. Outward is towards
/// phi > 0: the surface normal, turned for reversed faces and for mirroring locations.
class FaceSurface {
 public:
  /// `face` with the orientation it has in its shape.
  explicit FaceSurface(const TopoDS_Face& face);

  [[nodiscard]] SurfaceType type() const { return type_; }
  [[nodiscard]] bool analytic() const;  ///< plane, cylinder, cone, sphere or torus
  [[nodiscard]] const BRepAdaptor_Surface& adaptor() const { return adaptor_; }
  /// Seen along the outward normal, face boundaries run counter-clockwise unless mirrored.
  [[nodiscard]] bool mirrored() const { return mirrored_; }

  [[nodiscard]] Vec3 point(const Eigen::Vector2d& uv) const;
  /// False where the surface has no normal (poles, apices, collapsed sides).
  [[nodiscard]] bool pointAndNormal(const Eigen::Vector2d& uv, Vec3& point, Vec3& normal) const;

  /// Closest point of the untrimmed surface to x near `start`. Analytic surfaces: closed form;
  /// others: damped Newton within the surface's bounds, converged when the tangential residual is
  /// below `tolerance` (a length).
  [[nodiscard]] SurfaceFoot foot(const Vec3& x, double tolerance, Eigen::Vector2d start) const;

  /// Plane with outward normal if the face is one, B-spline planes within `tolerance` included.
  [[nodiscard]] std::optional<Plane> plane(double tolerance) const;

 private:
  [[nodiscard]] SurfaceFoot newtonFoot(const Vec3& x, double tolerance,
                                       const Eigen::Vector2d& start) const;
  [[nodiscard]] Eigen::Vector2d clamped(Eigen::Vector2d uv) const;
  void findBasis();
  struct Bending;
  [[nodiscard]] Bending bendingAt(const Eigen::Vector2d& uv, const Vec3& x) const;
  [[nodiscard]] std::optional<Bending> bendingOfOffset(const Eigen::Vector2d& uv,
                                                       const Vec3& x) const;

  BRepAdaptor_Surface adaptor_;
  Handle(Adaptor3d_Surface) basis_;  ///< of an offset surface; null for others
  double height_ = 0;                ///< over its basis, along the basis's normal
  SurfaceType type_ = SurfaceType::Other;
  bool flipped_ = false;
  bool mirrored_ = false;
  bool uPeriodic_ = false;
  bool vPeriodic_ = false;
  Eigen::Vector2d low_, high_;          ///< natural bounds of the surface
  Eigen::Vector2d faceLow_, faceHigh_;  ///< bounds of the face in (u,v)
};

[[nodiscard]] inline Vec3 toVec3(const gp_XYZ& p) { return {p.X(), p.Y(), p.Z()}; }
[[nodiscard]] inline gp_Pnt toPnt(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

}  // namespace phront::cad
