// Faces with a length of their own on the command line: --distance-of F3=2, name:lid*=0.1in.
#pragma once

#include <string>
#include <vector>

#include "cli.h"
#include "phront/cad/exchange.h"
#include "phront/cad/move_faces.h"

namespace phront::cli {

struct FaceWish {
  std::vector<std::string> terms;  ///< FACE=D, as given
};

struct FaceLength {
  cad::FaceId face;
  double length = 0;  ///< mm, signed
};

/// --distance-of.
void addFaceWish(CLI::App& command, FaceWish& wish);

/// Bare numbers count in the unit of `common`. Error: one sentence.
[[nodiscard]] Result<std::vector<FaceLength>> resolve(const FaceWish& wish, const cad::Model& model,
                                                      const CommonOptions& common);

/// The model with these faces moved, so that an offset by `distance` (mm) leaves each of them at
/// its own.
[[nodiscard]] Result<cad::Model> withFacesMoved(const FaceWish& wish, const cad::Model& model,
                                                double distance, const CommonOptions& common);

}  // namespace phront::cli
