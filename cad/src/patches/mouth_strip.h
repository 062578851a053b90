// The pipe round one edge of a narrow mouth.
#pragma once

#include <Geom_BSplineSurface.hxx>
#include <deque>
#include <gp_Pnt.hxx>
#include <gp_Vec.hxx>
#include <utility>
#include <vector>

#include "patches/mouth_pipes.h"
#include "patches/swept_surface.h"

namespace phront::cad {

class MouthStrip;
using MouthStrips = std::deque<MouthStrip>;  ///< of one half of the rim, in order

/// Along it runs f in [0, 1], as its half of the rim does; across it u in [0, 1] as in
/// SweptSurface. One side stays, the other is cut off.
class MouthStrip {
 public:
  /// Keeps a reference to `edge`.
  explicit MouthStrip(const MouthEdge& edge);

  /// Chooses the side to keep: the one away from `others`, the strips of the other half. False when
  /// there is none, or when nothing is to be cut off, or without a surface.
  [[nodiscard]] bool prepare(const MouthStrips& others);

  [[nodiscard]] const PipeFrame& frame() const { return edge_.frame; }
  [[nodiscard]] const SweptSurface& sections() const { return sections_; }
  [[nodiscard]] const Handle(Geom_BSplineSurface) & surface() const { return surface_; }
  [[nodiscard]] bool forward() const { return edge_.forward; }
  [[nodiscard]] bool keepsImage2() const { return keepsImage2_; }

  [[nodiscard]] double length() const;
  [[nodiscard]] double parameter(double f) const;  ///< of the edge
  [[nodiscard]] gp_Pnt value(double f, double u) const;
  void derivatives(double f, double u, gp_Pnt& point, gp_Vec& alongF, gp_Vec& acrossU) const;
  /// On the section at f: share 0 at the image that is kept, 1 at the other.
  [[nodiscard]] gp_Pnt onSection(double f, double share) const;
  [[nodiscard]] double across(double f, const gp_Pnt& p) const;
  /// Nearest of many points of the edge: distance and f.
  [[nodiscard]] std::pair<double, double> nearest(const gp_Pnt& p) const;

 private:
  const MouthEdge& edge_;
  SweptSurface sections_;
  Handle(Geom_BSplineSurface) surface_;
  std::vector<gp_Pnt> rim_;  ///< points at equal steps of f
  bool keepsImage2_ = true;
};

}  // namespace phront::cad
