// The offset surfaces of a model's faces, each trimmed, not sewn to solids.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "phront/cad/shape.h"
#include "phront/cad/tessellate.h"
#include "phront/progress.h"
#include "phront/status.h"

namespace phront::cad {

struct SurfacesOptions {
  double distance = 0;  ///< d, mm, signed: along the faces' outward normals
  std::optional<double> tolerance = std::nullopt;  ///< mm, bound on |phi - d|; default 1 % of |d|
  int threads = 0;                                 ///< 0: all cores
  double timeLimit = 75;                           ///< s, > 0: all faces together
};

/// What became of a face.
enum class FaceOffsetKind {
  Exact,     ///< plane, cylinder, cone, sphere, torus, revolution or extrusion in closed form
  Fitted,    ///< a spline, or swept along one, within the tolerance
  Vanished,  ///< no part of its offset is on the front
  Failed,    ///< see `trouble`
};

struct FaceOffset {
  FaceOffsetKind kind = FaceOffsetKind::Failed;
  SurfaceType type = SurfaceType::Other;  ///< of the input face
  int surfaces = 0;                       ///< trimmed surfaces that stem from it
  bool whole = false;                     ///< its loops are those of the face: nothing was cut off
  int inputPoles = 0;                     ///< of a spline, or of the curve that is swept; else 0
  int poles = 0;                          ///< of its offsets
  double fitError = 0;   ///< mm, largest |S_d - (S + d n)| found over the whole domain
  double deviation = 0;  ///< mm, largest | |phi| - |d| | of samples all over the trimmed surfaces
  std::string trouble;   ///< one sentence when it failed
};

struct BodySurfaces {
  std::string name;
  std::vector<FaceOffset> faces;  ///< in the order of the body's faces
};

struct SurfacesResult {
  Model model;  ///< one body per body that has any left: its trimmed offset surfaces, unsewn
  std::vector<BodySurfaces> bodies;
  SurfacesOptions options;  ///< as resolved
  std::vector<std::string> warnings;
  [[nodiscard]] int count(FaceOffsetKind kind) const;
  [[nodiscard]] double deviation() const;  ///< mm, largest
};

/// Offsets the surface of every face. (u,v) are kept: a point of an offset surface stems from the
/// face's point at the same parameters. Surfaces are cut back to where they are |d| away from the
/// body, by the distance field; at convex edges they end where the face ends, rounds are not added.
/// Every face is guarded on its own: one that fails costs the others nothing. Fails with
/// InvalidArgument, UnreadableInput (a body that cannot be measured), Cancelled.
[[nodiscard]] Result<SurfacesResult> offsetSurfaces(const Model& model,
                                                    const SurfacesOptions& options,
                                                    const Progress& progress = {});

}  // namespace phront::cad
