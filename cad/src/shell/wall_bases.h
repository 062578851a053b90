// What the walls of a shell are measured from, as its options have it.
#pragma once

#include <cstddef>
#include <vector>

#include "judge/check_shell.h"
#include "phront/cad/shell_shape.h"

namespace phront::cad {

[[nodiscard]] ShellWalls wallsOf(const ShellOptions& options);

/// 0-based, of the body with this index.
[[nodiscard]] std::vector<int> openFacesOf(const ShellOptions& options, std::size_t body);

/// For every body that needs one: with the faces moved that have a thickness of their own, and
/// inwards going on beyond openings that are not planar. Fails as moveFaces(), and with
/// NotSupported for openings that are not planar where there is a wall outside.
[[nodiscard]] Result<std::vector<WallBases>> wallBasesOf(const Model& model,
                                                         const ShellOptions& options);

}  // namespace phront::cad
