// Faces of a model by name: what --open and the like understand.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "phront/cad/shape.h"
#include "phront/status.h"

namespace phront::cad {

struct FaceId {
  std::size_t body = 0;  ///< index into Model::bodies
  int face = 0;          ///< 0-based, in the order of the body's faces
  friend bool operator==(const FaceId&, const FaceId&) = default;
};

/// Faces that a list names, each once, in the order of the model. Terms are separated by commas:
/// - `F<n>`: the n-th face of the file, from 1, as `phront info -v` lists them
/// - `name:TEXT`: faces whose name in the file is TEXT; `*` stands for any characters
/// - `normal:+z` (or -z, +x, ...): planar faces whose outward normal is that axis
/// - `area:max`: the face with the largest area
/// Fails with InvalidArgument when a term is not understood or names no face.
[[nodiscard]] Result<std::vector<FaceId>> selectFaces(const Model& model, const std::string& terms);

}  // namespace phront::cad
