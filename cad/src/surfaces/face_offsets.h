// The trimmed offsets of all faces of a body, each made in a guarded process of its own.
#pragma once

#include <TopoDS_Compound.hxx>
#include <TopoDS_Face.hxx>
#include <vector>

#include "deadline.h"
#include "phront/progress.h"
#include "phront/status.h"
#include "surfaces/trimmed_offset.h"

namespace phront::cad {

/// One for each face, in their order; a face that fails, or for which no time is left, says so in
/// its report. `threads`: that many faces at a time, 0: all cores. Fails with Cancelled.
[[nodiscard]] Result<std::vector<TrimmedOffset>> offsetFaces(const std::vector<TopoDS_Face>& faces,
                                                             const TrimRequest& request,
                                                             int threads, const TrueDistance& phi,
                                                             const Deadline& deadline,
                                                             const Progress& progress);

[[nodiscard]] TopoDS_Compound compoundOf(const std::vector<TopoDS_Face>& faces);

}  // namespace phront::cad
