// Faces moved along their normals, their neighbours extended or cut to meet them: what gives faces
// an offset of their own.
#pragma once

#include <vector>

#include "phront/cad/select_faces.h"
#include "phront/cad/shape.h"
#include "phront/status.h"

namespace phront::cad {

struct FaceMove {
  FaceId face;
  double distance = 0;  ///< mm, along the outward normal: positive grows the solid
};

struct MovedModel {
  Model model;  ///< bodies in their order; names and colours go with the faces
  /// For every face of every body the face of the original body that it was, 0-based.
  std::vector<std::vector<int>> origins;
};

/// Moves planes, cylinders, cones, spheres and tori of solids. Neighbours stay on their surfaces
/// and meet the moved face at sharp edges. Smooth neighbours must be moved by the same distance,
/// unless the face is a plane that moves to where they bend, as the side of a fillet does inwards.
/// To offset by d, but a face by D, move that face by D - d first. Fails with InvalidArgument (no
/// such face, no solid, no finite distance), NotSupported and a sentence that names the face (a
/// freeform face, a smooth neighbour that stays, a face that would be gone), Failed, ResourceLimit.
[[nodiscard]] Result<MovedModel> moveFaces(const Model& model, const std::vector<FaceMove>& moves);

}  // namespace phront::cad
