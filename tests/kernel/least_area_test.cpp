#include "phront/least_area.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace phront {
namespace {

std::vector<Vec3> ring(int corners, double radius, double turn = 1) {
  std::vector<Vec3> points;
  for (int i = 0; i < corners; ++i) {
    const double t = turn * 2 * std::numbers::pi * i / corners;
    points.emplace_back(radius * std::cos(t), radius * std::sin(t), 0);
  }
  return points;
}

double areaOf(const std::vector<std::array<Index, 3>>& triangles, const std::vector<Vec3>& points) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles)
    sum += 0.5 * (points[b] - points[a]).cross(points[c] - points[a])[2];
  return sum;
}

TEST(LeastAreaTriangles, NoFlatOnesWhereCornersLieInLine) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
  const auto triangles = leastAreaTriangles({0, 1, 2, 3, 4}, points, Flat::Avoided);
  ASSERT_EQ(triangles.size(), 3U);
  double sum = 0;
  for (const auto& [a, b, c] : triangles) {
    const Vec3 area = 0.5 * (points[b] - points[a]).cross(points[c] - points[a]);
    EXPECT_GT(area[2], 0.1) << "a flat one";
    sum += area[2];
  }
  EXPECT_NEAR(sum, 4, 1e-12);
  EXPECT_TRUE(leastAreaTriangles({0, 1}, points, Flat::Allowed).empty());
  EXPECT_TRUE(leastAreaTriangles({0, 1, 0}, points, Flat::Allowed).empty());
}

TEST(LeastAreaTriangles, ASlitGetsNoTriangleOfCornersInLine) {
  // Two rows of corners a millionth apart: every triangle is a needle.
  std::vector<Vec3> points;
  for (int i = 0; i <= 5; ++i) points.emplace_back(i, 0, 0);
  for (int i = 5; i >= 0; --i) points.emplace_back(i, 1e-6, 0);
  std::vector<Index> polygon(points.size());
  for (std::size_t i = 0; i < polygon.size(); ++i) polygon[i] = static_cast<Index>(i);
  const auto triangles = leastAreaTriangles(polygon, points, Flat::Avoided);
  ASSERT_EQ(triangles.size(), points.size() - 2);
  for (const auto& t : triangles) EXPECT_GT(areaOf({t}, points), 4e-7);
}

TEST(LeastAreaTriangles, SidesThatAreTakenAreNotMadeAgain) {
  const std::vector<Vec3> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1.2, 0}};
  const auto has = [](const auto& triangles, Index a, Index b) {
    return std::any_of(triangles.begin(), triangles.end(), [&](const auto& t) {
      return std::count(t.begin(), t.end(), a) + std::count(t.begin(), t.end(), b) == 2;
    });
  };
  const std::vector<Index> polygon{0, 1, 2, 3};
  for (const auto& [a, b] : {std::pair<Index, Index>{0, 2}, std::pair<Index, Index>{1, 3}}) {
    const auto triangles = leastAreaTriangles(polygon, square, Flat::Avoided, {{a, b}, {0, 1}});
    ASSERT_EQ(triangles.size(), 2U);
    EXPECT_FALSE(has(triangles, a, b));
  }
  EXPECT_TRUE(leastAreaTriangles(polygon, square, Flat::Avoided, {{0, 2}, {1, 3}}).empty());
}

TEST(JoinLoops, ARingBetweenTwoLoopsIsOnePolygon) {
  std::vector<Vec3> points = ring(24, 2);
  const std::vector<Vec3> inner = ring(12, 1, -1);
  points.insert(points.end(), inner.begin(), inner.end());
  std::vector<std::vector<Index>> loops(2);
  for (Index i = 0; i < 36; ++i) loops[i < 24 ? 0 : 1].push_back(i);
  const std::vector<Index> polygon = joinLoops(loops, points);
  EXPECT_EQ(polygon.size(), 38U);  // the side that joins them is used both ways
  const auto triangles = leastAreaTriangles(polygon, points, Flat::Avoided);
  ASSERT_EQ(triangles.size(), 36U);
  const auto area = [](int n, double r) {
    return 0.5 * n * r * r * std::sin(2 * std::numbers::pi / n);
  };
  EXPECT_NEAR(areaOf(triangles, points), area(24, 2) - area(12, 1), 1e-9);
}

}  // namespace
}  // namespace phront
