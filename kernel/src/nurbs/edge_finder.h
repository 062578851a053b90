// Corners of curves and edges of surfaces: where the normal jumps, or turns in no length.
#pragma once

#include <functional>
#include <vector>

#include "phront/offset_nurbs.h"

namespace phront {

class EdgeFinder {
 public:
  EdgeFinder(const Knots& along, const NurbsOffsetOptions& options)
      : along_(along), options_(options) {}

  /// Along one line.
  void look(const std::function<Vec3(double)>& normal, const std::function<Vec3(double)>& point);

  /// Found so far, overlapping ones as one.
  [[nodiscard]] std::vector<Interval> strips() const;

 private:
  struct Line;
  void lookInside(const Line& line, double low, double high, const Vec3& before, const Vec3& after,
                  int depth);

  const Knots& along_;
  const NurbsOffsetOptions& options_;
  std::vector<Interval> found_;
};

}  // namespace phront
