#include "phront/curve_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace phront {
namespace {

constexpr double kPi = std::numbers::pi;

CurveMesh circle(const Vec2& centre, double radius, int sides, bool clockwise = false) {
  std::vector<Vec2> points;
  for (int i = 0; i < sides; ++i) {
    const double angle = (clockwise ? -2 : 2) * kPi * i / sides;
    points.emplace_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  return curveThrough(points, true);
}

CurveDistance built(const CurveMesh& mesh) {
  auto distance = CurveDistance::build(mesh);
  EXPECT_TRUE(distance);
  return std::move(*distance);
}

TEST(CurveMesh, AreasAndLengths) {
  EXPECT_NEAR(signedArea(circle({3, 4}, 2, 1000)), 4 * kPi, 1e-4);
  EXPECT_NEAR(signedArea(circle({3, 4}, 2, 1000, true)), -4 * kPi, 1e-4);
  EXPECT_NEAR(length(circle({3, 4}, 2, 1000)), 4 * kPi, 1e-4);
  const CurveMesh ring = joined(circle({0, 0}, 2, 64), circle({0, 0}, 1, 64, true));
  EXPECT_EQ(ring.curve(63), 0);
  EXPECT_EQ(ring.curve(64), 1);
  EXPECT_GT(signedArea(ring), 0);
}

// Brute force over all segments, for the distance; the sign is that of the ring.
TEST(CurveDistance, AgreesWithBruteForce) {
  const CurveMesh ring = joined(circle({0, 0}, 2, 97), circle({0.3, 0.1}, 1, 61, true));
  const CurveDistance distance = built(ring);
  EXPECT_TRUE(distance.closed());
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> coordinate(-3, 3);
  int inside = 0;
  for (int n = 0; n < 5000; ++n) {
    const Vec2 x(coordinate(rng), coordinate(rng));
    double nearest = 1e9;
    for (const auto& [a, b] : ring.segments) {
      const Vec2 p = ring.points[static_cast<std::size_t>(a)];
      const Vec2 along = ring.points[static_cast<std::size_t>(b)] - p;
      const double t = std::clamp((x - p).dot(along) / along.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (x - p - t * along).norm());
    }
    const CurveFoot foot = distance.foot(x);
    EXPECT_NEAR(foot.distance, nearest, 1e-14);
    const double fromOuter = x.norm() - 2;
    const double fromInner = (x - Vec2(0.3, 0.1)).norm() - 1;
    if (std::min(std::abs(fromOuter), std::abs(fromInner)) < 0.01) continue;  // chords
    const bool material = fromOuter < 0 && fromInner > 0;
    inside += material ? 1 : 0;
    EXPECT_EQ(foot.sign, material ? -1 : 1) << x.transpose();
    EXPECT_NEAR((distance.gradient(x, foot) - foot.sign * (x - foot.point) / foot.distance).norm(),
                0, 1e-14);
  }
  EXPECT_GT(inside, 500);
}

// Loops that touch or cross themselves: both lobes of a limacon and its inner loop are inside.
TEST(CurveDistance, LoopsMayCross) {
  std::vector<Vec2> points;
  for (int i = 0; i < 400; ++i) {
    const double angle = 2 * kPi * i / 400;
    points.emplace_back((1 + 2 * std::cos(angle)) * Vec2(std::cos(angle), std::sin(angle)));
  }
  const CurveDistance limacon = built(curveThrough(points, true));
  EXPECT_EQ(limacon.windingNumber({0.5, 0}), 2);
  EXPECT_EQ(limacon.windingNumber({2, 0}), 1);
  EXPECT_EQ(limacon.windingNumber({-1, 0}), 0);
  EXPECT_EQ(limacon.foot({0.5, 0}).sign, -1);
  EXPECT_EQ(limacon.foot({2, 0}).sign, -1);
  EXPECT_EQ(limacon.foot({-1, 0}).sign, 1);
}

TEST(CurveDistance, OpenCurvesHaveSidesAndBorders) {
  const CurveDistance corner = built(curveThrough({{0, 0}, {2, 0}, {2, 2}}, false));
  EXPECT_FALSE(corner.closed());
  EXPECT_EQ(corner.foot({1, 0.5}).sign, -1);  // left
  EXPECT_EQ(corner.foot({1, -0.5}).sign, 1);
  EXPECT_EQ(corner.foot({3, -1}).sign, 1);  // around the corner
  EXPECT_FALSE(corner.foot({3, -1}).beyondBorder);
  EXPECT_TRUE(corner.foot({-1, 0.5}).beyondBorder);
  EXPECT_FALSE(corner.foot({0, 0.5}).beyondBorder);
}

TEST(CurveDistance, RefusesBadInput) {
  EXPECT_FALSE(CurveDistance::build({}));
  CurveMesh mesh = circle({0, 0}, 1, 8);
  mesh.points[3].x() = std::nan("");
  EXPECT_FALSE(CurveDistance::build(mesh));
  mesh = circle({0, 0}, 1, 8);
  mesh.segments[2][1] = 8;
  EXPECT_FALSE(CurveDistance::build(mesh));
  mesh = circle({0, 0}, 1, 8);
  mesh.curveOf = {0};
  EXPECT_FALSE(CurveDistance::build(mesh));
}

}  // namespace
}  // namespace phront
