#include "tessellate/body_distance.h"

#include <algorithm>
#include <cmath>

#include "patches/patch_tools.h"
#include "phront/cad/shape_occt.h"

namespace phront::cad {
namespace {

// Triangles follow the faces to this share of |d|: far below the 1 % that a result may deviate, and
// what is left disappears where feet are refined on the true surface.
constexpr double kDeflectionOfDistance = 0.004;
// ... but not finer than this share of the diagonal: tiny distances on large parts.
constexpr double kFinestDeflection = 2e-5;
constexpr double kFinestOfSheet = 5e-5;  // no roundings, no facets
// ... and not coarser: large distances still need the shape.
constexpr double kCoarsestDeflection = 3e-4;

double deflectionFor(const Body& body, double distance) {
  const double diagonal = diagonalOf(occtShape(body.shape));
  const double finest = body.kind == BodyKind::Solid ? kFinestDeflection : kFinestOfSheet;
  return std::clamp(kDeflectionOfDistance * std::abs(distance), finest * diagonal,
                    kCoarsestDeflection * diagonal);
}

}  // namespace

Result<TrueDistance> distanceOf(const Body& body, double distance, double seconds,
                                double fineness) {
  TessellateOptions tessellation;
  tessellation.distance = std::abs(distance);
  tessellation.deflection = deflectionFor(body, distance) / fineness;
  tessellation.smoothTolerance = tessellation.deflection;
  tessellation.timeLimit = seconds;
  Result<Tessellation> mesh = tessellate(body, tessellation);
  if (!mesh && mesh.error().code == ErrorCode::Failed) {
    return fail(ErrorCode::UnreadableInput, "the part cannot be measured: " + mesh.error().message +
                                                " Repair it in the CAD system it comes from.");
  }
  if (!mesh) return tl::unexpected(mesh.error());
  return TrueDistance::build(occtShape(body.shape), std::move(*mesh));
}

}  // namespace phront::cad
