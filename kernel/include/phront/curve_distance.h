// Exact signed distance to curves in the plane.
#pragma once

#include <limits>
#include <memory>

#include "phront/curve_mesh.h"
#include "phront/status.h"
#include "phront/types.h"

namespace phront {

/// Closest point of the curves to a query point x.
struct CurveFoot {
  Vec2 point = Vec2::Zero();                                  ///< cp(x), on a segment
  double distance = std::numeric_limits<double>::infinity();  ///< |x - cp(x)| >= 0
  double sign = 1;            ///< -1 inside material, +1 outside; open curves: side of the segment
  Index segment = kNone;      ///< that holds the foot
  double parameter = 0;       ///< of the foot along it, 0 .. 1
  bool beyondBorder = false;  ///< foot on a free end of an open curve: phi has no sign here

  [[nodiscard]] double phi() const { return sign * distance; }
};

/// Signed distance to a CurveMesh; phi < 0 in material. Closed curves (every point is entered as
/// often as it is left): material is where they wind around x (not zero times), so that loops may
/// touch, overlap or cross themselves. Open curves: the side decides, left is material. Immutable;
/// queries are thread safe.
class CurveDistance {
 public:
  /// Fails with InvalidArgument without segments, or with NaN or infinite points or indices out of
  /// range. Segments of length zero count as points.
  [[nodiscard]] static Result<CurveDistance> build(CurveMesh mesh);

  [[nodiscard]] const CurveMesh& mesh() const;
  [[nodiscard]] bool closed() const;
  [[nodiscard]] Eigen::AlignedBox2d box() const;

  /// `reach` bounds the search: beyond it segment == kNone.
  [[nodiscard]] CurveFoot foot(const Vec2& x,
                               double reach = std::numeric_limits<double>::infinity()) const;
  /// Walks along the curve from a segment as long as the distance falls: the local foot of that
  /// branch (no sign: always +1).
  [[nodiscard]] CurveFoot footAlong(const Vec2& x, Index segment) const;

  [[nodiscard]] double signedDistance(const Vec2& x) const { return foot(x).phi(); }
  /// Unit gradient of phi at x from its foot; the normal of the segment when x lies on it.
  [[nodiscard]] Vec2 gradient(const Vec2& x, const CurveFoot& foot) const;
  /// Times the closed curves wind around x, counter-clockwise; open curves count as far as they
  /// cross the ray to the right of x.
  [[nodiscard]] int windingNumber(const Vec2& x) const;

  CurveDistance(CurveDistance&&) noexcept;
  CurveDistance& operator=(CurveDistance&&) noexcept;
  ~CurveDistance();

 private:
  struct Impl;
  explicit CurveDistance(std::unique_ptr<const Impl> impl);
  std::unique_ptr<const Impl> impl_;
};

}  // namespace phront
