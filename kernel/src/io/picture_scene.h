// What a picture shows, ready to draw: nothing of the model's topology is left in it. This is all
// that crosses the border to the drawing module, which is loaded at run time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "phront/picture.h"

namespace phront::io {

/// One item: triangles with a normal and a colour per point, and line segments.
struct SceneView {
  std::vector<Vec3> points;   ///< doubled where shading has a crease
  std::vector<Vec3> normals;  ///< unit or zero
  std::vector<std::array<std::uint8_t, 3>> colors;
  std::vector<std::array<Index, 3>> triangles;
  std::vector<std::array<Vec3, 2>> lines;
  std::string caption;
  Vec3 center = Vec3::Zero();  ///< in the middle of the view
};

/// Views side by side, one parallel projection for all.
struct Scene {
  std::vector<SceneView> views;
  Vec3 towardsEye = Vec3::UnitX();  ///< unit
  Vec3 up = Vec3::UnitZ();          ///< unit, orthogonal to towardsEye
  double halfHeight = 1;            ///< model units from the middle of a view to its top
  double radius = 1;                ///< every point lies this close to the centre of its view
  int width = 0;                    ///< pixels, whole picture
  int height = 0;
};

/// Share of the picture's height under the views that is left for captions.
inline constexpr double kCaptionShare = 0.09;

/// Edges to be drawn as lines: between different faces, free, non-manifold or sharper than 30
/// degrees. Shading has a crease there and nowhere else. `mesh` must have valid indices and finite
/// points.
[[nodiscard]] SceneView makeView(const PictureItem& item);

[[nodiscard]] Scene makeScene(std::span<const PictureItem> items, const PictureOptions& options);

/// What the drawing module exports under kDrawSymbol: fills in the bytes of a PNG file. (Found by
/// name at run time, hence C linkage, hence the result as a parameter.)
using DrawScene = void (*)(const Scene& scene, Result<std::string>& png);
inline constexpr const char* kDrawSymbol = "phrontDrawScene";

}  // namespace phront::io
