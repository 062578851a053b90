#include "phront/offset_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace phront {
namespace {

constexpr double kPi = std::numbers::pi;

CurveMesh rectangle(double a, double b) {
  return curveThrough({{0, 0}, {a, 0}, {a, b}, {0, b}}, true);
}

CurveMesh star(int points, double outer, double inner) {
  std::vector<Vec2> corners;
  for (int i = 0; i < 2 * points; ++i) {
    const double angle = kPi * i / points;
    corners.emplace_back((i % 2 == 0 ? outer : inner) * Vec2(std::cos(angle), std::sin(angle)));
  }
  return curveThrough(corners, true);
}

OffsetCurve offsetOf(const CurveMesh& mesh, const OffsetCurveOptions& options) {
  const auto distance = CurveDistance::build(mesh);
  EXPECT_TRUE(distance);
  auto result = offsetCurve(*distance, options);
  EXPECT_TRUE(result) << result.error().message;
  return *result;
}

// Steiner: area grows by d times the perimeter and a disc.
TEST(OffsetCurve, ConvexCurvesObeySteiner) {
  const OffsetCurve grown = offsetOf(rectangle(3, 2), {.distance = 0.5});
  EXPECT_EQ(curveCount(grown.curves), 1);
  EXPECT_NEAR(signedArea(grown.curves), 6 + 0.5 * 10 + kPi * 0.25, 5e-3);
  EXPECT_LE(grown.deviation, 0.5e-3);
  EXPECT_LT(grown.curves.points.size(), 200U);
}

// Inwards a rectangle keeps its corners: four points, exact.
TEST(OffsetCurve, CornersAreExact) {
  const OffsetCurve shrunk = offsetOf(rectangle(3, 2), {.distance = -0.3});
  EXPECT_EQ(curveCount(shrunk.curves), 1);
  EXPECT_NEAR(signedArea(shrunk.curves), 2.4 * 1.4, 1e-9);
  EXPECT_LE(shrunk.deviation, 1e-9);
  for (const Vec2& corner : {Vec2(0.3, 0.3), Vec2(2.7, 0.3), Vec2(2.7, 1.7), Vec2(0.3, 1.7)}) {
    double nearest = 1;
    for (const Vec2& p : shrunk.curves.points) nearest = std::min(nearest, (p - corner).norm());
    EXPECT_LT(nearest, 1e-9);
  }
}

TEST(OffsetCurve, EmptyExactlyBeyondTheInradius) {
  EXPECT_FALSE(offsetOf(rectangle(3, 2), {.distance = -0.97}).curves.segments.empty());
  EXPECT_TRUE(offsetOf(rectangle(3, 2), {.distance = -1.01}).curves.segments.empty());
}

TEST(OffsetCurve, KeepsItsTolerance) {
  for (const double distance : {0.4, 0.1, -0.08}) {
    for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
      const OffsetCurve result =
          offsetOf(star(5, 1, 0.4), {.distance = distance, .tolerance = tolerance});
      EXPECT_FALSE(result.curves.segments.empty());
      EXPECT_LE(result.deviation, tolerance);
    }
  }
}

// Where fronts of two finely divided curves meet: a wavy line, on both sides.
TEST(OffsetCurve, KeepsItsToleranceWhereCurvesMeet) {
  std::vector<Vec2> points;
  for (int i = 0; i <= 2000; ++i) points.emplace_back(0.005 * i, 0.6 * std::sin(0.01 * i));
  points.emplace_back(10, 4);
  points.emplace_back(0, 4);
  for (const double distance : {0.9, -0.9}) {
    const OffsetCurve result = offsetOf(curveThrough(points, true), {.distance = distance});
    EXPECT_FALSE(result.curves.segments.empty());
    EXPECT_LE(result.deviation, 0.9e-3);
  }
}

// Fronts that just touch, and an arc that shrinks to its centre: thinner than any grid.
TEST(OffsetCurve, KeepsItsToleranceWhereFrontsTouch) {
  std::vector<Vec2> slot;  // a stadium with a disc in it, so that fronts of both touch at -1
  std::vector<Vec2> disc;
  for (int i = 0; i <= 200; ++i) {
    const double angle = kPi * (i / 200.0 - 0.5);
    slot.emplace_back(6 + 3 * std::cos(angle), 3 * std::sin(angle));
  }
  for (int i = 0; i <= 200; ++i) {
    const double angle = kPi * (i / 200.0 + 0.5);
    slot.emplace_back(-6 + 3 * std::cos(angle), 3 * std::sin(angle));
  }
  for (int i = 0; i < 400; ++i) {
    const double angle = -2 * kPi * i / 400;
    disc.emplace_back(std::cos(angle), std::sin(angle));
  }
  const CurveMesh part = joined(curveThrough(slot, true), curveThrough(disc, true));
  for (const double distance : {-1.0, -1.001}) {
    const OffsetCurve result = offsetOf(part, {.distance = distance});
    EXPECT_FALSE(result.curves.segments.empty());
    EXPECT_LE(result.deviation, 1.01e-3) << distance;
  }
  const CurveMesh grown = offsetOf(rectangle(6, 4), {.distance = 1, .tolerance = 1e-4}).curves;
  const OffsetCurve back = offsetOf(grown, {.distance = -1});
  EXPECT_LE(back.deviation, 1e-3);
  EXPECT_NEAR(signedArea(back.curves), 24, 0.02);
}

// A dumbbell inwards: the bar goes, two pieces stay; outwards the gap of a C closes to a hole.
TEST(OffsetCurve, FrontsSplitAndMerge) {
  const CurveMesh dumbbell = curveThrough({{0, 0},
                                           {2, 0},
                                           {2, 0.8},
                                           {4, 0.8},
                                           {4, 0},
                                           {6, 0},
                                           {6, 2},
                                           {4, 2},
                                           {4, 1.2},
                                           {2, 1.2},
                                           {2, 2},
                                           {0, 2}},
                                          true);
  EXPECT_EQ(curveCount(offsetOf(dumbbell, {.distance = -0.1}).curves), 1);
  EXPECT_EQ(curveCount(offsetOf(dumbbell, {.distance = -0.3}).curves), 2);
  const CurveMesh letter = curveThrough({{0, 0},
                                         {3, 0},
                                         {3, 1.3},
                                         {2, 1.3},
                                         {2, 1},
                                         {1, 1},
                                         {1, 3},
                                         {2, 3},
                                         {2, 1.7},
                                         {3, 1.7},
                                         {3, 4},
                                         {0, 4}},
                                        true);
  EXPECT_EQ(curveCount(offsetOf(letter, {.distance = 0.1}).curves), 1);
  const OffsetCurve closed = offsetOf(letter, {.distance = 0.3});
  EXPECT_EQ(curveCount(closed.curves), 2);  // outline and hole
  EXPECT_GT(signedArea(closed.curves), signedArea(letter));
}

TEST(OffsetCurve, OpenCurvesHaveOneSide) {
  const OffsetCurve side =
      offsetOf(curveThrough({{0, 0}, {2, 0}, {2, 2}}, false), {.distance = 0.5});
  EXPECT_EQ(curveCount(side.curves), 1);
  EXPECT_LE(side.deviation, 0.5e-3);
  // Two straight parts of length 2 and a quarter circle, less up to a cell at the free ends.
  EXPECT_NEAR(length(side.curves), 4 + 0.25 * kPi, 2.5 * side.spacing);
  for (const Vec2& p : side.curves.points) EXPECT_TRUE(p.y() < 0 || p.x() > 2);
}

TEST(OffsetCurve, TurnedAndScaledIsTheSame) {
  const CurveMesh base = star(7, 1, 0.6);
  const double area = signedArea(offsetOf(base, {.distance = 0.1}).curves);
  const Eigen::Rotation2Dd turn(0.4);
  for (const double scale : {1e-3, 1e3}) {
    CurveMesh moved = base;
    for (Vec2& p : moved.points) p = scale * (turn * p) + Vec2(scale, -2 * scale);
    const double other = signedArea(offsetOf(moved, {.distance = 0.1 * scale}).curves);
    EXPECT_NEAR(other / (scale * scale), area, 2e-3);
  }
}

TEST(OffsetCurve, SameBitsAtAnyThreadCount) {
  const OffsetCurve one = offsetOf(star(7, 1, 0.6), {.distance = 0.1, .threads = 1});
  const OffsetCurve two = offsetOf(star(7, 1, 0.6), {.distance = 0.1, .threads = 2});
  EXPECT_EQ(one.curves.points, two.curves.points);
  EXPECT_EQ(one.curves.segments, two.curves.segments);
}

TEST(OffsetCurve, RefusesBadInput) {
  const auto distance = CurveDistance::build(rectangle(1, 1));
  EXPECT_FALSE(offsetCurve(*distance, {.distance = 0}));
  EXPECT_FALSE(offsetCurve(*distance, {.distance = std::nan("")}));
  EXPECT_FALSE(offsetCurve(*distance, {.distance = 1, .tolerance = 0.0}));
  EXPECT_FALSE(offsetCurve(*distance, {.distance = 1, .threads = -1}));
  const auto tiny = offsetCurve(*distance, {.distance = 1e-7});
  ASSERT_FALSE(tiny);
  EXPECT_EQ(tiny.error().code, ErrorCode::ResourceLimit);
}

}  // namespace
}  // namespace phront
