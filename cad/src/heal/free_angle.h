// Where on a circle nothing lies: the place for a seam.
#pragma once

#include <vector>

namespace phront::cad {

struct FreeAngle {
  double middle = 0;  ///< rad, in [0, 2 pi)
  double width = 0;   ///< rad; 2 pi when nothing lies on the circle
};

/// The widest gap between `angles` (rad, any period). A gap between samples of one thing counts as
/// one, too: ask for wider gaps than those.
[[nodiscard]] FreeAngle widestFreeAngle(std::vector<double> angles);

}  // namespace phront::cad
