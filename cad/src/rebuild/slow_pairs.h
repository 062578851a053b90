// Pairs of faces that OpenCASCADE cannot intersect in any reasonable time.
#pragma once

#include <TopoDS_Face.hxx>
#include <set>
#include <utility>
#include <vector>

#include "rebuild/fuse.h"

namespace phront::cad {

/// The pairs (i < j) of faces that may cross whose intersection takes longer than some seconds:
/// mostly tangent ones, and freeform ones that turn back into themselves. Each is tried in a child,
/// but for those of planes and quadrics, which never take long.
[[nodiscard]] std::set<std::pair<std::size_t, std::size_t>> slowPairs(
    const std::vector<TopoDS_Face>& faces, const MayCross& mayCross);

}  // namespace phront::cad
