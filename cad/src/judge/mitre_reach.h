// Where a mitre join may leave the offset.
#pragma once

#include <vector>

#include "judge/check_sampling.h"

namespace phront::cad {

/// The edges of a part that an offset by `distance` (mm, signed) goes round, and how far the
/// corners of its mitre may be from them: `limit` times |distance|.
class MitreReach {
 public:
  MitreReach(const ModelDistance& in, double distance, double limit);

  /// Is the point near enough to one of them?
  [[nodiscard]] bool holds(const Vec3& x) const;
  [[nodiscard]] double farthest() const { return reach_; }  ///< from the part, mm

 private:
  struct Segment {
    Vec3 from;
    Vec3 along;
  };
  std::vector<Segment> segments_;
  double reach_;
};

}  // namespace phront::cad
