#include "phront/fill_hole.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>

namespace phront {
namespace {

std::vector<Vec3> ring(int corners, double radius, double z, double turn = 1) {
  std::vector<Vec3> points;
  for (int i = 0; i < corners; ++i) {
    const double t = turn * 2 * std::numbers::pi * i / corners;
    points.emplace_back(radius * std::cos(t), radius * std::sin(t), z);
  }
  return points;
}

double areaOf(const HoleFill& fill) {
  double sum = 0;
  for (const auto& [a, b, c] : fill.triangles) {
    const auto at = [&](Index p) { return fill.points[static_cast<std::size_t>(p)]; };
    sum += 0.5 * (at(b) - at(a)).cross(at(c) - at(a)).norm();
  }
  return sum;
}

/// Sides that one triangle uses; every other is used once in each direction.
std::size_t borderSides(const HoleFill& fill) {
  std::map<std::pair<Index, Index>, int> uses;
  for (const auto& t : fill.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++uses[{t[k], t[(k + 1) % 3]}];
  std::size_t border = 0;
  for (const auto& [side, count] : uses) {
    EXPECT_EQ(count, 1);
    border += uses.contains({side.second, side.first}) ? 0 : 1;
  }
  return border;
}

const ToSurface toPlane = [](const Vec3& x) { return std::optional(Vec3(x[0], x[1], 0)); };
const ToSurface toSphere = [](const Vec3& x) { return std::optional(x.normalized().eval()); };

TEST(FillHole, APolygonInItsPlaneNeedsNoPointInside) {
  // Not convex: its corners alternate between two circles.
  std::vector<Vec3> star;
  for (int i = 0; i < 10; ++i) star.push_back((i % 2 ? 1 : 2) * ring(10, 1, 0)[i]);
  const auto fill = fillHole({star}, toPlane, {.tolerance = 1e-3, .longestSide = 10});
  ASSERT_TRUE(fill) << fill.error().message;
  EXPECT_EQ(fill->points.size(), 10U);
  EXPECT_EQ(fill->triangles.size(), 8U);
  EXPECT_NEAR(areaOf(*fill), 10 * 0.5 * 2 * std::sin(std::numbers::pi / 5), 1e-12);
  EXPECT_EQ(fill->deviation, 0);
}

TEST(FillHole, ACapComesWithinTheToleranceOfItsSphere) {
  // Sides of the loop stay as they are: they are .0012 off the sphere.
  const auto cap = ring(48, std::sqrt(0.75), 0.5);
  for (const double tolerance : {0.03, 0.01, 0.003}) {
    const auto fill = fillHole({cap}, toSphere, {.tolerance = tolerance, .longestSide = 10});
    ASSERT_TRUE(fill) << fill.error().message;
    EXPECT_LE(fill->deviation, tolerance);
    EXPECT_EQ(borderSides(*fill), cap.size());
    for (const Vec3& p : fill->points) EXPECT_NEAR(p.norm(), 1, 1e-12);
    // By Archimedes 2 pi times the height.
    EXPECT_NEAR(areaOf(*fill), std::numbers::pi, 4 * tolerance);
    for (const auto& [a, b, c] : fill->triangles) {
      const auto at = [&](Index p) { return fill->points[static_cast<std::size_t>(p)]; };
      EXPECT_GT((at(b) - at(a)).cross(at(c) - at(a)).dot(at(a)), 0) << "turned over";
    }
  }
}

TEST(FillHole, LoopsOfOneHoleAreJoined) {
  const auto outer = ring(24, 2, 0);
  const auto inner = ring(12, 1, 0, -1);
  const auto fill = fillHole({outer, inner}, toPlane, {.tolerance = 1e-3, .longestSide = 1});
  ASSERT_TRUE(fill) << fill.error().message;
  EXPECT_EQ(borderSides(*fill), outer.size() + inner.size());
  const auto polygon = [](int n, double r) {
    return 0.5 * n * r * r * std::sin(2 * std::numbers::pi / n);
  };
  EXPECT_NEAR(areaOf(*fill), polygon(24, 2) - polygon(12, 1), 1e-9);
}

TEST(LeastAreaTriangles, NoNeedlesWhereCornersLieInLine) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
  const auto triangles = leastAreaTriangles({0, 1, 2, 3, 4}, points, Needles::Avoided);
  ASSERT_EQ(triangles.size(), 3U);
  double sum = 0;
  for (const auto& [a, b, c] : triangles) {
    const Vec3 area = 0.5 * (points[b] - points[a]).cross(points[c] - points[a]);
    EXPECT_GT(area[2], 0.1) << "a needle";
    sum += area[2];
  }
  EXPECT_NEAR(sum, 4, 1e-12);
  EXPECT_TRUE(leastAreaTriangles({0, 1}, points, Needles::Allowed).empty());
  EXPECT_TRUE(leastAreaTriangles({0, 1, 0}, points, Needles::Allowed).empty());
}

TEST(FillHole, BadHolesAreRefused) {
  const FillOptions options{.tolerance = 0.1, .longestSide = 1};
  const auto code = [&](const std::vector<std::vector<Vec3>>& loops, const FillOptions& with) {
    const auto fill = fillHole(loops, toPlane, with);
    EXPECT_FALSE(fill);
    return fill ? ErrorCode::Failed : fill.error().code;
  };
  EXPECT_EQ(code({}, options), ErrorCode::InvalidArgument);
  EXPECT_EQ(code({{{0, 0, 0}, {1, 0, 0}}}, options), ErrorCode::InvalidArgument);
  auto broken = ring(5, 1, 0);
  broken[2][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code({broken}, options), ErrorCode::InvalidArgument);
  EXPECT_EQ(code({ring(5, 1, 0)}, {.tolerance = 0, .longestSide = 1}), ErrorCode::InvalidArgument);
  EXPECT_EQ(code({ring(700, 1, 0)}, options), ErrorCode::ResourceLimit);
}

}  // namespace
}  // namespace phront
