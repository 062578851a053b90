// Cuts that General Fuse missed, found by phi.
#pragma once

#include <TopoDS_Shape.hxx>
#include <vector>

#include "rebuild/select.h"

namespace phront::cad {

/// Lines along which live pieces, and any next to open edges, leave the offset: edges on those
/// pieces' surfaces. Where they end another piece crosses, or the piece crosses itself. `noise`,
/// mm: how far pieces may be off the level.
[[nodiscard]] std::vector<TopoDS_Shape> frontCuts(const std::vector<JudgedFace>& pieces, bool solid,
                                                  double distance, double noise,
                                                  const TrueDistance& phi);

}  // namespace phront::cad
