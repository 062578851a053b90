// A NURBS surface and its offset at all pairs of some parameters.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "nurbs/spline_fit.h"
#include "phront/nurbs.h"

namespace phront {

/// Whether the weights matter.
[[nodiscard]] bool isRational(const std::vector<double>& weights);

/// One row for each u, three numbers for each v.
struct SurfaceGrid {
  Rows points;
  Rows crosses;  ///< S_u x S_v
};
[[nodiscard]] SurfaceGrid gridOf(const NurbsSurface& surface, std::span<const double> us,
                                 std::span<const double> vs);

/// Normals and offset points of a surface, S_u x S_v normalised; where it vanishes (poles,
/// degenerate edges) the limit from inside. Where the surface folds back on itself S_u x S_v turns
/// over; the normal does not, but goes on as it was on the side where the surface is stretched
/// most.
class OffsetSurface {
 public:
  OffsetSurface(const NurbsSurface& surface, double distance);

  [[nodiscard]] bool folds() const { return !normals_.empty(); }
  /// Of a surface that was fitted to a fold, S_u x S_v swings through every direction in a narrow
  /// band there. Smooth: what is left of S_u x S_v on the fold itself is taken off beside it.
  void smoothFolds(bool smooth) { smoothed_ = smooth && folds(); }

  [[nodiscard]] bool hasNormals() const { return typical_ > 0; }
  [[nodiscard]] double typicalCross() const { return typical_; }  ///< |S_u x S_v|
  /// Zero where there is none.
  [[nodiscard]] Vec3 normal(double u, double v) const;
  [[nodiscard]] Vec3 point(double u, double v) const;  ///< S + d n
  /// S + d n as rows of (x, y, z), or (w x, w y, w z, w) when the surface is rational.
  [[nodiscard]] Rows at(std::span<const double> us, std::span<const double> vs) const;
  [[nodiscard]] int stride() const { return rational_ ? 4 : 3; }

 private:
  [[nodiscard]] Vec3 cross(double u, double v) const;
  [[nodiscard]] Vec3 normal(double u, double v, const Vec3& cross) const;
  [[nodiscard]] Vec3 limit(double u, double v) const;  ///< where S_u x S_v vanishes
  /// What S_u x S_v keeps on the fold, where its part along the normal vanishes: it turns the
  /// direction beside the fold. Sought along u or v; none where the domain ends first.
  [[nodiscard]] std::optional<Vec3> residueAlong(bool alongU, double u, double v) const;
  [[nodiscard]] Vec3 residue(double u, double v) const;
  /// Normals sampled all over the surface, none turned over; nothing when no fold was found.
  void findFolds();
  [[nodiscard]] const Vec3& turnedLike(double u, double v) const;  ///< the nearest of them
  [[nodiscard]] Vec3 unfolded(double u, double v, const Vec3& normal) const;

  const NurbsSurface& surface_;
  double distance_;
  bool rational_;
  bool smoothed_ = false;
  double typical_ = 0;  ///< |S_u x S_v|
  std::vector<double> us_, vs_;
  std::vector<Vec3> normals_;  ///< i + j * us_.size()
};

}  // namespace phront
