// Pieces that spoil a solid.
#pragma once

#include <TopoDS_Face.hxx>
#include <optional>
#include <vector>

#include "tessellate/true_distance.h"

namespace phront::cad {

struct SortedPieces {
  std::vector<TopoDS_Face> kept, removed;
};

/// Removes pieces that are not valid or cannot be tessellated, that leave the level `distance` (mm,
/// signed) or their edges, that use an edge too often, or at which open edges do not close. Large
/// ones are cut around their faults first. Empty when that fails. May throw, hang or crash with
/// OpenCASCADE.
[[nodiscard]] std::optional<SortedPieces> removeFaultyPieces(std::vector<TopoDS_Face> pieces,
                                                             double distance,
                                                             const TrueDistance& phi);

}  // namespace phront::cad
