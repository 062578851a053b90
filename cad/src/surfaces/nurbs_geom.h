// OpenCASCADE's B-splines to the kernel's plain ones and back.
#pragma once

#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>

#include "phront/nurbs.h"

namespace phront::cad {

/// A domain in (u,v).
struct ParameterBox {
  Interval u, v;
};

/// The part of a B-spline over an interval of its parameter, clamped and not periodic. Ends within
/// round-off of the spline's own take those.
[[nodiscard]] NurbsCurve nurbsOf(const Geom_BSplineCurve& curve, const Interval& part);
[[nodiscard]] NurbsSurface nurbsOf(const Geom_BSplineSurface& surface, const ParameterBox& part);

[[nodiscard]] Handle(Geom_BSplineCurve) geomOf(const NurbsCurve& curve);
[[nodiscard]] Handle(Geom_BSplineSurface) geomOf(const NurbsSurface& surface);

}  // namespace phront::cad
