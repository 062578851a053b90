// Patches at which what is kept does not close.
#pragma once

#include <TopoDS_Face.hxx>
#include <vector>

#include "rebuild/select.h"

namespace phront::cad {

/// For each patch: does it have a piece, live or dead, at an edge that live pieces use only once?
[[nodiscard]] std::vector<bool> openPatches(const std::vector<TopoDS_Face>& patches,
                                            const std::vector<JudgedFace>& pieces);

}  // namespace phront::cad
