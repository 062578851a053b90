// Where the pipes of the two halves of a rim meet.
#pragma once

#include <optional>
#include <vector>

#include "patches/mouth_strip.h"

namespace phront::cad {

/// A point of the ridge on a strip of either half.
struct RidgePoint {
  double s = 0;  ///< along the first half: strip number + f
  double u = 0;
  double otherS = 0;
  double otherU = 0;
  gp_Pnt point;
};

/// The ridge between one strip of the first half and one of the other.
struct RidgePiece {
  std::size_t strip = 0;
  std::size_t otherStrip = 0;
  std::vector<RidgePoint> points;  ///< s and otherS grow; consecutive pieces share their ends
};

/// The whole ridge, from the one tip to the other. nullopt where it cannot be followed.
[[nodiscard]] std::optional<std::vector<RidgePiece>> followRidge(const MouthStrips& one,
                                                                 const MouthStrips& other);

}  // namespace phront::cad
