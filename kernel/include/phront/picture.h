// A PNG of meshes, drawn without a display.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "phront/status.h"
#include "phront/tri_mesh.h"

namespace phront {

struct PictureItem {
  TriMesh mesh{};
  std::string caption{};                          ///< one line under the view
  std::array<double, 3> color{0.62, 0.72, 0.84};  ///< RGB in [0, 1]
  bool colorByFace = false;                       ///< one hue per faceOf
};

struct PictureOptions {
  int width = 1600;  ///< pixels, whole picture
  int height = 800;
  Vec3 view{1.0, -1.4, 0.9};  ///< from the model towards the eye
};

/// Draws the items side by side at one scale, shaded, with feature edges (between different faceOf,
/// free, or sharper than 30 degrees) as dark lines. NotSupported when built without VTK or when no
/// software GL is there; CannotWrite.
[[nodiscard]] Result<void> writePicture(std::span<const PictureItem> items,
                                        const std::filesystem::path& path,
                                        const PictureOptions& options = {});

}  // namespace phront
