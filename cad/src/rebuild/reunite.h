// Faces that healing has divided, one again.
#pragma once

#include <TopoDS_Shape.hxx>

#include "tessellate/true_distance.h"

namespace phront::cad {

/// `solids` with neighbouring faces made one where they lie on the same surface and stem from the
/// same feature of the part that `phi` is the distance of; so do the edges between them. Null when
/// there is nothing to reunite, or OpenCASCADE does not manage within `seconds`.
[[nodiscard]] TopoDS_Shape reuniteFaces(const TopoDS_Shape& solids, const TrueDistance& phi,
                                        double seconds);

}  // namespace phront::cad
