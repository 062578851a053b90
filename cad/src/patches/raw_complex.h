// All patches that the offset can consist of.
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

namespace phront::cad {

struct RawOptions {
  double distance = 0;     ///< mm, signed
  double smoothAngle = 0;  ///< rad, see EdgeTable
  double tolerance = 0;    ///< mm, approximation of curves and surfaces without closed form
};

struct RawComplex {
  std::vector<TopoDS_Face> faces;
  int missing = 0;  ///< patches that could not be built
  std::vector<std::string> notes;
};

/// Offset of every face, pipe of every edge that is convex on the offset side, sphere patch of
/// every vertex with a normal cone. Contains the true offset (arc joins) unless patches are
/// missing.
[[nodiscard]] RawComplex buildRawComplex(const TopoDS_Shape& healed, const RawOptions& options);

}  // namespace phront::cad
