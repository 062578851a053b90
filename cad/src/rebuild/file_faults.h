// Faces that no file can carry.
#pragma once

#include <TopoDS_Face.hxx>
#include <vector>

#include "judge/check_topology.h"
#include "phront/types.h"

namespace phront::cad {

/// Writes the faces as one shell to a STEP file and reads it back: STEP carries neither tolerances
/// nor parameter curves, so a face that is sound in memory may not be. Points on those that come
/// back not valid, farther than `gap` (mm) from their edges, or so that they cannot be tessellated;
/// none where no file can be written. May throw, hang or crash with OpenCASCADE.
[[nodiscard]] std::vector<Vec3> faultsInFile(const std::vector<TopoDS_Face>& faces, double gap,
                                             const MeshSize& size);

}  // namespace phront::cad
