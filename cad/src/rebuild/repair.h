// Pieces that do not close, repaired by phi.
#pragma once

#include <functional>

#include "exchange/guard.h"
#include "rebuild/assemble.h"

namespace phront::cad {

struct RepairRequest {
  AssembleOptions options;
  double fuzzy = 0;           ///< mm, of General Fuse
  double levelTolerance = 0;  ///< mm: how far pieces may be off the level
  std::function<std::vector<JudgedFace>(const std::vector<TopoDS_Face>&)> judge;
};

/// Closed, valid, and every face tessellates at a size of the order of `size`, mm: in memory or as
/// read back from a file.
[[nodiscard]] bool isSound(const Assembly& assembly, double size);

/// Cuts the pieces where phi shows that they leave the offset. In a child of its own, as
/// OpenCASCADE may take long over such cuts. A sound assembly, or fails with Failed (none came
/// out), ResourceLimit.
[[nodiscard]] Result<Assembly> repairPieces(const std::vector<JudgedFace>& pieces,
                                            const RepairRequest& request, const TrueDistance& phi,
                                            const GuardLimits& limits);

}  // namespace phront::cad
