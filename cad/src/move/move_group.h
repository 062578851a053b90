// One group of faces that go on smoothly into one another, moved together.
#pragma once

#include <TopoDS_Shape.hxx>
#include <cstddef>
#include <vector>

#include "phront/status.h"

namespace phront::cad {

/// rad, between normals: faces at a flatter edge go on smoothly into one another. Extended they
/// would meet far away.
inline constexpr double kSmoothNeighbours = 0.03;

struct GroupMove {
  std::vector<int> faces;    ///< 0-based, of the solid
  double distance = 0;       ///< mm, along the outward normal
  std::vector<int> numbers;  ///< per face of the solid: what sentences call it

  [[nodiscard]] int numberOf(int face) const { return numbers[static_cast<std::size_t>(face)]; }
};

struct MovedSolid {
  TopoDS_Shape solid;
  std::vector<int> origins;  ///< per face: which face of the solid it was, 0-based
};

/// Fails with NotSupported or Failed and a sentence. May throw, hang or crash with OpenCASCADE:
/// call it in runInChild.
[[nodiscard]] Result<MovedSolid> moveGroup(const TopoDS_Shape& solid, const GroupMove& move);

}  // namespace phront::cad
