// Booleans of solids in a guarded process.
#pragma once

#include <TopoDS_Shape.hxx>
#include <vector>

#include "phront/status.h"

namespace phront::cad {

/// `from` without `tools`, all in mm; `fuzzy`: how far coinciding boundaries may be apart. Null
/// when nothing is left. Fails with Failed, ResourceLimit.
[[nodiscard]] Result<TopoDS_Shape> cutSolid(const TopoDS_Shape& from,
                                            const std::vector<TopoDS_Shape>& tools, double fuzzy,
                                            double seconds);

}  // namespace phront::cad
