#include "field/safe_regions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "meshes.h"

namespace phront {
namespace {

struct Case {
  TriMesh mesh;
  double band;
  std::size_t regions;
};

/// Each node farther than h/2 lies in a tile of a region of its sign; regions have one sign.
void check(const Case& c) {
  const auto surface = SurfaceDistance::build(c.mesh);
  ASSERT_TRUE(surface.has_value()) << surface.error().message;
  const auto field =
      solveDistanceField(*surface, {.spacing = 0.1, .bandMin = -c.band, .bandMax = c.band});
  ASSERT_TRUE(field.has_value()) << field.error().message;
  const std::vector<SafeRegion> regions = safeRegions(*field, field->values(), 2);
  EXPECT_EQ(regions.size(), c.regions);
  std::array<std::set<Index>, 2> covered;
  for (const SafeRegion& region : regions) {
    const DistanceField::Tile& tile = field->tiles()[static_cast<std::size_t>(region.tile)];
    EXPECT_EQ(*field->phi(field->node(tile, region.node)), region.phi);
    EXPECT_GT(std::abs(region.phi), 0.05);
    covered[region.phi < 0 ? 1 : 0].insert(region.tiles.begin(), region.tiles.end());
    EXPECT_EQ(std::set<Index>(region.tiles.begin(), region.tiles.end()).size(),
              region.tiles.size());
  }
  field->forNodes([&](const GridIndex& node, double phi, Index) {
    if (std::abs(phi) < 0.0501) return;
    const Index tile = field->findTile({node[0] >> 3, node[1] >> 3, node[2] >> 3});
    EXPECT_TRUE(covered[phi < 0 ? 1 : 0].contains(tile));
  });
}

TEST(SafeRegions, InsideAndOutside) { check({test::sphere(1, 4), 0.3, 2}); }
TEST(SafeRegions, AroundAHole) { check({test::torus(2, 0.6, 48, 24), 0.3, 2}); }
TEST(SafeRegions, FarApartOrTooThinForBothSides) {
  TriMesh mesh;
  test::append(mesh, test::sphere(1, 4));
  test::append(mesh, test::sphere(1, 4, Vec3(3, 0, 0)));
  check({mesh, 0.3, 4});
  // Seen from either, the other lies within the band: one outside.
  check({mesh, 1.5, 3});
  // A wall of half a spacing has no safe node within.
  check({test::box(Vec3(0, 0, 0), Vec3(2, 2, 0.05)), 0.3, 1});
}

}  // namespace
}  // namespace phront
