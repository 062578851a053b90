// Lines in the plane as a picture and as data.
#pragma once

#include <filesystem>
#include <vector>

#include "phront/curve_mesh.h"

namespace thesis {

struct Lines {
  phront::CurveMesh curves;
  double value = 0;     ///< written beside the points: level, layer, ...
  bool strong = false;  ///< drawn thicker: the geometry
};

/// PATH.png: all lines over one another, seen from above; PATH.csv: x,y,value,curve of each
/// segment's ends, a blank line between curves. Without software GL the picture is left out, and
/// said so.
void writeFigure(const std::vector<Lines>& lines, const std::filesystem::path& path);

}  // namespace thesis
