// Level lines of a function in the plane that is known on one side only.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

namespace phront::cad {

using Vec2 = Eigen::Vector2d;

/// Clearance at a point of the plane: negative where there is too little, and there with its
/// gradient. What is positive need not be smooth, nor grow: a front meets others only where it
/// does.
struct Clearance {
  double value = 0;
  Vec2 gradient = Vec2::Zero();
};
using ClearanceAt = std::function<Clearance(const Vec2&)>;

/// One point on each side.
struct ContourSeed {
  Vec2 without;  ///< value < 0
  Vec2 with;     ///< value >= 0
};

struct ContourOptions {
  Vec2 low, high;    ///< lines end outside this box
  double chord = 0;  ///< largest distance of the segments from the line
  double longestStep = 0;
  int maxQueries = 60'000;  ///< of the clearance, for all lines together
};

struct Contour {
  std::vector<Vec2> points;
  bool closed = false;  ///< the last point is followed by the first
};

/// Adds the lines of clearance 0 through the seeds that `lines` does not hold yet, by predictor and
/// corrector (Allgower & Georg 1990): steps along the tangent, Newton back to the line from the
/// side where it is smooth. Corners are kept to within the chord. What winds from corner to corner
/// ends; after maxQueries, or some thousand for lines that end inside, no more lines are found.
void traceContours(const ClearanceAt& clearance, const std::vector<ContourSeed>& seeds,
                   const ContourOptions& options, std::vector<Contour>& lines);

/// The same from a grid over rising `us` and `vs`, two at least: coarser, on the safe side
/// (segments between points of the line may leave out what lies between them and the line), but
/// lines never end inside the grid. `chord` as above.
[[nodiscard]] std::vector<Contour> gridContours(const ClearanceAt& clearance, double chord,
                                                std::span<const double> us,
                                                std::span<const double> vs);

}  // namespace phront::cad
