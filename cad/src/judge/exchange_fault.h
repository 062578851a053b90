// Whether a result survives a STEP file.
#pragma once

#include <string>
#include <vector>

#include "judge/check_topology.h"
#include "phront/cad/check.h"
#include "phront/cad/shape.h"

namespace phront::cad {

/// Writes the solids or sheets to a temporary STEP file and reads it back as any other program
/// would. Returns what is wrong with what comes back (not closed, not valid, faces that cannot be
/// tessellated), empty when nothing is. STEP carries no tolerances: edges that meet loosely in
/// memory may not meet in the file. `size`: see usualMeshSize().
[[nodiscard]] std::string exchangeFault(const Model& out, const MeshSize& size);

/// Makes the check of an offset (or a wall) that passes fail where `bodies` do not survive that.
void checkExchange(const std::vector<Body>& bodies, const OffsetScale& scale, CheckResult& check);

}  // namespace phront::cad
