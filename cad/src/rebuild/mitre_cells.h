// Extended faces divide space into cells; those that the offset reaches are its mitre.
#pragma once

#include <TopoDS_Shape.hxx>
#include <vector>

#include "tessellate/true_distance.h"

namespace phront::cad {

/// `solid`, the offset by `distance` (mm, signed) of the part that `phi` is the distance of,
/// without the faces `round`: those beside them are extended by `extension` (mm) and cut with one
/// another and with the rest. Null when that encloses nothing. May throw, hang or crash with
/// OpenCASCADE: call it in runInChild.
[[nodiscard]] TopoDS_Shape mitreOfCells(const TopoDS_Shape& solid,
                                        const std::vector<TopoDS_Shape>& round, double extension,
                                        double distance, const TrueDistance& phi);

}  // namespace phront::cad
