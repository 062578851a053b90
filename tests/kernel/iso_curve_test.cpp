#include "phront/iso_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "grids.h"

namespace phront {
namespace {

using test::valuesOf;

TEST(IsoCurve, CircleConvergesQuadratically) {
  const auto error = [](std::int32_t cells) {
    const NodeGrid grid{{cells + 1, cells + 1, 1}, 2.0 / cells, Vec3(-1, -1, 0)};
    const auto line = isoCurve(grid, valuesOf(grid, [](const Vec3& x) { return x.norm(); }), 0.7);
    EXPECT_TRUE(line);
    EXPECT_EQ(curveCount(*line), 1);
    EXPECT_EQ(line->points.size(), line->segments.size());  // closed
    double squares = 0;  // the largest error depends on where the line cuts the grid
    for (const Vec2& p : line->points) squares += std::pow(p.norm() - 0.7, 2);
    EXPECT_NEAR(signedArea(*line), std::numbers::pi * 0.49, 4.0 / cells / cells);
    return std::sqrt(squares / static_cast<double>(line->points.size()));
  };
  EXPECT_GT(std::log2(error(50) / error(200)) / 2, 1.8);
}

// The distance to two points: one line while they are near, two when the level is small.
TEST(IsoCurve, LinesSplitAndMerge) {
  const NodeGrid grid{{81, 41, 1}, 0.05, Vec3(-2, -1, 0)};
  const auto values = valuesOf(grid, [](const Vec3& x) {
    return std::min((x - Vec3(-0.5, 0, 0)).norm(), (x - Vec3(0.5, 0, 0)).norm());
  });
  const auto two = isoCurve(grid, values, 0.4);
  const auto one = isoCurve(grid, values, 0.6);
  ASSERT_TRUE(two && one);
  EXPECT_EQ(curveCount(*two), 2);
  EXPECT_EQ(curveCount(*one), 1);
}

// Values at random give every case of a cell many times. Whatever they are, each point of the
// inside of the grid is entered as often as it is left, and lower values lie to the left.
TEST(IsoCurve, RandomValuesGiveCleanLines) {
  const NodeGrid grid{{40, 30, 1}, 1, Vec3::Zero()};
  std::mt19937 rng(11);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto values = valuesOf(grid, [&](const Vec3&) { return unit(rng); });
  const auto lines = isoCurve(grid, values, 0.5);
  ASSERT_TRUE(lines);
  std::vector<int> out(lines->points.size(), 0);
  std::vector<int> in(lines->points.size(), 0);
  for (const auto& [a, b] : lines->segments) {
    ++out[static_cast<std::size_t>(a)];
    ++in[static_cast<std::size_t>(b)];
  }
  for (std::size_t p = 0; p < lines->points.size(); ++p) {
    const Vec2& x = lines->points[p];
    const bool wall = x.x() == 0 || x.y() == 0 || x.x() == 39 || x.y() == 29;
    EXPECT_LE(out[p], 1);
    EXPECT_LE(in[p], 1);
    EXPECT_EQ(out[p] + in[p], wall ? 1 : 2);
  }
  // Area to the left of the lines, closed along the walls, against the bilinear area by sampling.
  for (const auto& [a, b] : lines->segments) {
    const Vec2 p = lines->points[static_cast<std::size_t>(a)];
    const Vec2 q = lines->points[static_cast<std::size_t>(b)];
    const Vec2 middle = 0.5 * (p + q);
    const Vec2 cell(std::floor(middle.x()), std::floor(middle.y()));
    double low = 0;
    int lows = 0;
    for (int k = 0; k < 4; ++k) {
      const Vec2 corner = cell + Vec2(k % 2, k / 2);
      const double v = values[static_cast<std::size_t>(grid.number(
          static_cast<std::int32_t>(corner.x()), static_cast<std::int32_t>(corner.y())))];
      if (v >= 0.5) continue;
      const Vec2 along = q - p;
      const double side = along.x() * (corner - p).y() - along.y() * (corner - p).x();
      low = std::max(low, side);
      ++lows;
    }
    EXPECT_GT(lows, 0);
    EXPECT_GE(low, 0);  // at least one of the lower corners is on the left
  }
}

TEST(IsoCurve, SaddlesFollowTheBilinearSurface) {
  const NodeGrid grid{{2, 2, 1}, 1, Vec3::Zero()};
  // x (1-y) + ... : corners 0 and 3 (crosswise) low; the saddle value is 0.5 of the mean here.
  const std::vector<double> connected{0, 0.6, 0.6, 0};  // saddle 0.3
  const auto joined = isoCurve(grid, connected, 0.4);
  const auto apart = isoCurve(grid, connected, 0.2);
  ASSERT_TRUE(joined && apart);
  // Joined: each line cuts off a high corner, (1,0) or (0,1); apart: a low one, (0,0) or (1,1).
  const auto cutsOff = [](const CurveMesh& lines, const Vec2& corner) {
    for (const auto& [a, b] : lines.segments) {
      const Vec2 middle = 0.5 * (lines.points[static_cast<std::size_t>(a)] +
                                 lines.points[static_cast<std::size_t>(b)]);
      if ((middle - corner).norm() < 0.5) return true;
    }
    return false;
  };
  EXPECT_TRUE(cutsOff(*joined, {1, 0}) && cutsOff(*joined, {0, 1}));
  EXPECT_TRUE(cutsOff(*apart, {0, 0}) && cutsOff(*apart, {1, 1}));
}

TEST(IsoCurve, StopsWhereThereIsNoValue) {
  const NodeGrid grid{{21, 21, 1}, 0.1, Vec3(-1, -1, 0)};
  auto values = valuesOf(grid, [](const Vec3& x) { return x.norm(); });
  values[static_cast<std::size_t>(grid.number(17, 10))] = std::numeric_limits<double>::infinity();
  const auto line = isoCurve(grid, values, 0.65);
  ASSERT_TRUE(line);
  EXPECT_EQ(curveCount(*line), 1);
  EXPECT_EQ(line->points.size(), line->segments.size() + 1);  // open
}

TEST(IsoCurve, RefusesBadInput) {
  const std::vector<double> values(8, 0);
  EXPECT_FALSE(isoCurve({{2, 2, 2}, 1, Vec3::Zero()}, values, 0));
  EXPECT_FALSE(isoCurve({{2, 2, 1}, 1, Vec3::Zero()}, values, 0));
  EXPECT_FALSE(isoCurve({{4, 2, 1}, 0, Vec3::Zero()}, values, 0));
  EXPECT_FALSE(isoCurve({{4, 2, 1}, 1, Vec3::Zero()}, values, std::nan("")));
  EXPECT_TRUE(isoCurve({{4, 2, 1}, 1, Vec3::Zero()}, values, 0));
}

}  // namespace
}  // namespace phront
