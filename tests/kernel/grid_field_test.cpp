#include "phront/grid_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "meshes.h"

namespace phront {
namespace {

CurveDistance ring() {
  std::vector<Vec2> outer;
  std::vector<Vec2> inner;
  for (int i = 0; i < 400; ++i) {
    const double angle = 2 * std::numbers::pi * i / 400;
    outer.emplace_back(std::cos(angle), std::sin(angle));
    inner.emplace_back(0.4 * std::cos(-angle), 0.4 * std::sin(-angle));
  }
  return *CurveDistance::build(joined(curveThrough(outer, true), curveThrough(inner, true)));
}

// Signs must agree everywhere, magnitudes to the order of the scheme.
TEST(GridField, SweptAgreesWithExactInThePlane) {
  const CurveDistance curves = ring();
  const NodeGrid grid{{121, 101, 1}, 0.025, Vec3(-1.5, -1.25, 0)};
  const auto exact = solveGridField(grid, curves);
  ASSERT_TRUE(exact);
  for (const EikonalOrder order : {EikonalOrder::First, EikonalOrder::Second}) {
    const auto swept =
        solveGridField(grid, curves, {.solver = FieldSolver::Godunov, .order = order});
    ASSERT_TRUE(swept);
    EXPECT_GT(swept->sweeps, 0);
    double worst = 0;
    int inside = 0;
    for (std::size_t n = 0; n < exact->phi.size(); ++n) {
      EXPECT_EQ(std::signbit(swept->phi[n]), std::signbit(exact->phi[n]));
      if (swept->seed[n]) {
        EXPECT_EQ(swept->phi[n], exact->phi[n]);
      }
      inside += exact->phi[n] < 0 ? 1 : 0;
      worst = std::max(worst, std::abs(swept->phi[n] - exact->phi[n]));
    }
    EXPECT_GT(inside, 1000);
    EXPECT_LT(worst, grid.spacing);
  }
}

TEST(GridField, SweptAgreesWithExactInSpace) {
  const auto surface = SurfaceDistance::build(test::sphere(1, 4));
  ASSERT_TRUE(surface);
  const NodeGrid grid{{31, 33, 35}, 0.1, Vec3(-1.5, -1.6, -1.7)};
  const auto exact = solveGridField(grid, *surface);
  const auto swept = solveGridField(grid, *surface, {.solver = FieldSolver::Godunov});
  ASSERT_TRUE(exact && swept);
  double worst = 0;
  for (std::size_t n = 0; n < exact->phi.size(); ++n) {
    EXPECT_EQ(std::signbit(swept->phi[n]), std::signbit(exact->phi[n]));
    worst = std::max(worst, std::abs(swept->phi[n] - exact->phi[n]));
  }
  EXPECT_GT(worst, 0);  // it was swept
  EXPECT_LT(worst, grid.spacing);
}

// Numbers of nodes that blocks of eight do not divide; a closed shape and an open one.
TEST(GridField, ExactIsTheQueryAtEveryNode) {
  for (const TriMesh& mesh : {test::torus(0.7, 0.3, 40, 20), test::sheet(3)}) {
    const auto surface = SurfaceDistance::build(mesh);
    ASSERT_TRUE(surface);
    const NodeGrid grid{{19, 24, 9}, 0.12, Vec3(-1.05, -1.3, -0.6)};
    const auto exact = solveGridField(grid, *surface, {.threads = 2});
    ASSERT_TRUE(exact);
    for (std::int32_t k = 0, n = 0; k < grid.nodes[2]; ++k) {
      for (std::int32_t j = 0; j < grid.nodes[1]; ++j) {
        for (std::int32_t i = 0; i < grid.nodes[0]; ++i, ++n) {
          EXPECT_EQ(exact->phi[static_cast<std::size_t>(n)],
                    surface->signedDistance(grid.position(i, j, k)));
        }
      }
    }
  }
}

TEST(GridField, RefusesBadInput) {
  const CurveDistance curves = ring();
  EXPECT_FALSE(solveGridField({{5, 5, 5}, 1, Vec3::Zero()}, curves));
  EXPECT_FALSE(solveGridField({{5, 0, 1}, 1, Vec3::Zero()}, curves));
  EXPECT_FALSE(solveGridField({{5, 5, 1}, -1, Vec3::Zero()}, curves));
  // No node comes near the ring: nothing to start from.
  EXPECT_FALSE(
      solveGridField({{5, 5, 1}, 0.01, Vec3(9, 9, 0)}, curves, {.solver = FieldSolver::Godunov}));
}

TEST(GridField, OpenCurvesHaveTwoSides) {
  const auto open = CurveDistance::build(curveThrough({{0, 0}, {1, 0}}, false));
  ASSERT_TRUE(open);
  const NodeGrid grid{{31, 21, 1}, 0.1, Vec3(-1, -1.05, 0)};
  const auto swept = solveGridField(grid, *open, {.solver = FieldSolver::Godunov});
  ASSERT_TRUE(swept);
  for (std::int32_t j = 0; j < 21; ++j) {
    for (std::int32_t i = 0; i < 31; ++i) {
      const double phi = swept->phi[static_cast<std::size_t>(grid.number(i, j))];
      EXPECT_EQ(phi<0, grid.position(i, j).y()> 0);  // material is on the left
      EXPECT_NEAR(std::abs(phi), open->foot(grid.position(i, j).head<2>()).distance, 0.1);
    }
  }
}

}  // namespace
}  // namespace phront
