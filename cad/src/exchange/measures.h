// Area and volume of a shape.
#pragma once

#include <TopoDS_Shape.hxx>

namespace phront::cad {

/// mm^2, >= 0: of all faces. Integration with a fixed number of points: off by a thousandth on
/// rational B-splines.
[[nodiscard]] double areaOf(const TopoDS_Shape& shape);

/// By adaptive integration: the plain one is off by a thousandth on rational B-splines.
[[nodiscard]] double accurateAreaOf(const TopoDS_Shape& shape);

/// mm^3: that the faces enclose (divergence theorem), < 0 where they are inside out. Senseless for
/// faces that do not close.
[[nodiscard]] double volumeOf(const TopoDS_Shape& shape);

}  // namespace phront::cad
