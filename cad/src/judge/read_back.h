// A result as any other program gets it. STEP carries no tolerances: edges that meet loosely in
// memory may not meet in the file.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "judge/check_topology.h"
#include "phront/cad/check.h"
#include "phront/cad/shape.h"
#include "phront/status.h"

namespace phront::cad {

/// Writes the solids or sheets to a temporary STEP file and reads it back, without repair. nullopt
/// where there is no place for the file. Fails as writeModel() and readModel().
[[nodiscard]] Result<std::optional<Model>> readBack(const std::vector<Body>& bodies);

/// The same for models whose shapes are the same to the last bit, within one process. Never 0.
[[nodiscard]] std::size_t fingerprintOf(const Model& model);

/// What is wrong with what comes back (not closed, not valid, faces that cannot be tessellated),
/// empty when nothing is, or nothing can be tried. `size`: see usualMeshSize().
[[nodiscard]] std::string exchangeFault(const Model& out, const MeshSize& size);

/// Makes the check of an offset (or a wall) that passes fail where `bodies` do not survive that.
void checkExchange(const std::vector<Body>& bodies, const OffsetScale& scale, CheckResult& check);

}  // namespace phront::cad
