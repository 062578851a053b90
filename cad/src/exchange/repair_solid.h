// Sewing and repair of solids. Call in a guarded child.
#pragma once

#include <TopoDS_Shape.hxx>
#include <optional>
#include <string>
#include <vector>

#include "exchange/face_set.h"
#include "exchange/load_shapes.h"

namespace phront::cad {

struct RepairedBody {
  TopoDS_Shape shape;  ///< TopoDS_Solid or TopoDS_Shell
  bool solid = false;
  bool valid = true;  ///< false: a fault that could not be healed
  int turned = 0;     ///< faces of a sewn sheet that were the other way round
};

struct RepairContext {
  ShapeMarks& marks;  ///< they move to faces that replace others
  std::vector<std::string>& warnings;
  std::optional<double> sewTolerance;  ///< mm; automatic: sewToleranceOf(the faces)
  std::string label;                   ///< of the body, for sentences ("body 'cover'")
};

/// Sews faces that may belong together. Closed shells become solids with positive volume, the rest
/// connected sheets; nothing is said about it. Face order is kept within each.
[[nodiscard]] std::vector<RepairedBody> sewFaces(const FaceSet& faces, RepairContext& context);

/// Makes a solid what it claims to be: closed, its faces outwards, its volume positive, valid. What
/// cannot be closed comes back as sheets. Every change, and every fault that stays, gives a
/// warning.
[[nodiscard]] std::vector<RepairedBody> repairSolid(const TopoDS_Shape& solid,
                                                    RepairContext& context);

/// max(1e-6 mm, 1e-5 of the diagonal).
[[nodiscard]] double sewToleranceOf(const TopoDS_Shape& shape);

[[nodiscard]] double boxDiagonal(const TopoDS_Shape& shape);  ///< mm, tight; 0 when void

}  // namespace phront::cad
