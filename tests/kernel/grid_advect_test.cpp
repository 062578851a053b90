#include "phront/grid_advect.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "grids.h"

namespace phront {
namespace {

using test::valuesOf;

std::vector<Vec3> onCircle(double radius, int count) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.3) / count;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
  }
  return points;
}

/// Largest distance to where the points should be: on their rays.
double circleError(std::int32_t cells, double distance, std::optional<double> step) {
  const NodeGrid grid{{cells + 1, cells + 1, 1}, 2.0 / cells, Vec3(-1, -1, 0)};
  const auto phi = valuesOf(grid, [](const Vec3& x) { return x.norm() - 0.5; });
  const auto start = onCircle(0.5, 39);
  const auto moved = advectOnGrid(grid, phi, start, {.distance = distance, .step = step});
  EXPECT_TRUE(moved);
  double worst = 0;
  for (std::size_t i = 0; i < start.size(); ++i) {
    EXPECT_EQ(moved->status[i], AdvectStatus::Arrived);
    const Vec3 wanted = (0.5 + distance) / 0.5 * start[i];
    worst = std::max(worst, (moved->points[i] - wanted).norm());
  }
  return worst;
}

TEST(GridAdvect, CirclesGrowAndShrinkAlongRays) {
  for (const double distance : {0.25, -0.2}) {
    const double coarse = circleError(40, distance, std::nullopt);
    const double fine = circleError(80, distance, std::nullopt);
    EXPECT_LT(coarse, 0.02);
    EXPECT_GT(std::log2(coarse / fine), 1.5);  // smooth values: close to second order
  }
}

// The field is the limit, not the step.
TEST(GridAdvect, SmallStepsGainNothing) {
  EXPECT_NEAR(circleError(40, 0.25, 0.001), circleError(40, 0.25, std::nullopt), 2e-4);
}

TEST(GridAdvect, StopsAtTheMedialAxis) {
  const NodeGrid grid{{41, 41, 1}, 0.05, Vec3(-1, -1, 0)};
  // A slot of width 1 along x: points of both walls meet in the middle.
  const auto phi = valuesOf(grid, [](const Vec3& x) { return 0.5 - std::abs(x.y()); });
  const std::vector<Vec3> start{{0.1, 0.5, 0}, {-0.2, -0.5, 0}};
  const auto met = advectOnGrid(grid, phi, start, {.distance = 0.6});
  ASSERT_TRUE(met);
  for (std::size_t i = 0; i < start.size(); ++i) {
    EXPECT_EQ(met->status[i], AdvectStatus::Collided);
    EXPECT_NEAR(met->points[i].y(), 0, 0.05);
    EXPECT_NEAR(met->points[i].x(), start[i].x(), 1e-12);
  }
}

TEST(GridAdvect, WorksInSpaceAndStopsAtWalls) {
  const NodeGrid grid{{21, 21, 21}, 0.1, Vec3(-1, -1, -1)};
  const auto phi = valuesOf(grid, [](const Vec3& x) { return x.norm() - 0.5; });
  const std::vector<Vec3> start{0.5 * Vec3(1, 2, 3).normalized(),
                                0.5 * Vec3(-3, 1, 1).normalized()};
  const auto near = advectOnGrid(grid, phi, start, {.distance = 0.3});
  const auto far = advectOnGrid(grid, phi, start, {.distance = 2});
  ASSERT_TRUE(near && far);
  for (std::size_t i = 0; i < start.size(); ++i) {
    EXPECT_EQ(near->status[i], AdvectStatus::Arrived);
    EXPECT_NEAR((near->points[i] - 1.6 * start[i]).norm(), 0, 0.02);
    EXPECT_EQ(far->status[i], AdvectStatus::Border);
    EXPECT_LE(far->points[i].cwiseAbs().maxCoeff(), 1);
  }
}

TEST(GridAdvect, RefusesBadInput) {
  const NodeGrid grid{{4, 4, 1}, 1, Vec3::Zero()};
  const std::vector<double> phi(16, 0);
  const std::vector<Vec3> start{{1, 1, 0}};
  EXPECT_TRUE(advectOnGrid(grid, phi, start, {.distance = 1}));
  EXPECT_FALSE(advectOnGrid(grid, phi, start, {.distance = 0}));
  EXPECT_FALSE(advectOnGrid(grid, phi, start, {.distance = 1, .step = 0.0}));
  EXPECT_FALSE(advectOnGrid(grid, phi, start, {.distance = 1, .threads = -1}));
  EXPECT_FALSE(advectOnGrid(grid, std::vector<double>(15, 0), start, {.distance = 1}));
  EXPECT_FALSE(advectOnGrid(grid, phi, std::vector<Vec3>{{std::nan(""), 0, 0}}, {.distance = 1}));
}

}  // namespace
}  // namespace phront
