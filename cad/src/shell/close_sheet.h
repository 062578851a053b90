// From the two sides of a thickened sheet and its walls to a solid.
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "judge/thick_sheet.h"
#include "phront/status.h"

namespace phront::cad {

/// How faces that should meet are made to.
struct ClosingWay {
  std::string name;
  double sewing = 0;  ///< mm, > 0
  bool cut = false;   ///< faces are first cut where they cross, and those off the boundary dropped
  double fuzzy = 0;   ///< mm, of that cut
};

struct ThickSheetPieces {
  std::vector<TopoDS_Face> faces;  ///< both sides and the walls; may cross one another
  ShellWalls walls;
  double tolerance = 0;  ///< mm: how far a piece may be off the boundary
};

/// Solids. Fails with Failed when nothing closes. May throw, hang or crash with OpenCASCADE: call
/// it in runInChild.
[[nodiscard]] Result<TopoDS_Shape> closeSheet(const ThickSheetPieces& pieces,
                                              const TrueDistance& phi, const FreeBorder& border,
                                              const ClosingWay& way);

}  // namespace phront::cad
