// Work and memory of a band grow with its area, not with the volume around it.
#include <gtest/gtest.h>

#include <cstdio>

#include "meshes.h"
#include "phront/distance_field.h"

namespace phront {
namespace {

// Halving the spacing, the band with it, asks for 4 times the tiles on a surface and 8 in a volume.
// Tiles are whole, 8 h a side: coarser grids than the first here see no surface but a ball.
TEST(DistanceFieldGrowth, TilesOfABandQuadrupleWhenTheSpacingHalves) {
  const auto surface = SurfaceDistance::build(test::icosphere(5));
  ASSERT_TRUE(surface.has_value()) << surface.error().message;
  double spacing = 0.06;
  std::size_t before = 0;
  for (int size = 0; size < 5; ++size, spacing /= 2) {
    const auto field = solveDistanceField(
        *surface, {.spacing = spacing, .bandMin = -3 * spacing, .bandMax = 3 * spacing});
    ASSERT_TRUE(field.has_value()) << field.error().message;
    const std::size_t tiles = field->tiles().size();
    std::printf("h %g: %zu tiles\n", spacing, tiles);
    if (before > 0) {
      const double ratio = static_cast<double>(tiles) / static_cast<double>(before);
      EXPECT_GE(ratio, 3.4);
      EXPECT_LE(ratio, 4.6);
    }
    before = tiles;
  }
}

}  // namespace
}  // namespace phront
