// The line or circle that an edge's freeform curve is.
#pragma once

#include <Geom_Curve.hxx>
#include <TopoDS_Edge.hxx>
#include <optional>

namespace phront::cad {

struct CurveFit {
  Handle(Geom_Curve) curve;  ///< begins at the edge's start with parameter 0
  double last = 0;           ///< its parameter at the edge's end
  double deviation = 0;      ///< mm, largest distance between a point of the edge and it
};

/// Through the edge's ends, within `tolerance` (mm, > 0); nullopt where the edge is neither, where
/// it is one already by name, and where it is closed.
[[nodiscard]] std::optional<CurveFit> fitLineOrCircle(const TopoDS_Edge& edge, double tolerance);

}  // namespace phront::cad
