// What a moved face and its neighbours are cut from: the faces where they go, large enough to meet.
#pragma once

#include <TopoDS_Face.hxx>
#include <string>
#include <vector>

#include "move/move_group.h"
#include "patches/edge_table.h"
#include "phront/status.h"

namespace phront::cad {

struct ExtendedFace {
  TopoDS_Face face;
  int origin = -1;  ///< face of the table
};

/// The moved faces where they are moved to, and the neighbours that must grow to meet them there.
/// `tolerance` mm: what is flatter is a plane. Fails with NotSupported and a sentence.
[[nodiscard]] Result<std::vector<ExtendedFace>> extendedFaces(const EdgeTable& table,
                                                              const GroupMove& move,
                                                              double tolerance);

/// mm
[[nodiscard]] double distanceTo(const TopoDS_Shape& shape, const gp_Pnt& point);

[[nodiscard]] tl::unexpected<Error> cannotMove(const GroupMove& move, const std::string& why);

}  // namespace phront::cad
