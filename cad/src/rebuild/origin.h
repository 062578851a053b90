// What of a part a face of its offset stems from.
#pragma once

#include <TopoDS_Face.hxx>

#include "tessellate/true_distance.h"

namespace phront::cad {

/// The feature that most sample points of a face have their foot on; kNone without samples.
[[nodiscard]] Feature originOf(const TopoDS_Face& face, const TrueDistance& phi);

}  // namespace phront::cad
