// Surfaces that are closed but for narrow gaps.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "meshes.h"
#include "phront/distance_field.h"
#include "phront/iso_surface.h"

namespace phront {
namespace {

constexpr double kCrack = 0.02;

/// A sphere of radius 1 cut along the equator, the upper half lifted, every triangle with points of
/// its own there.
TriMesh crackedSphere() {
  TriMesh mesh = test::icosphere(3);
  mesh.faceOf.clear();
  mesh.edgeOf.clear();
  mesh.vertexOf.clear();
  const std::size_t count = mesh.points.size();
  std::vector<Index> lifted(count, kNone);
  for (auto& t : mesh.triangles) {
    double height = 0;
    for (const Index p : t) height += mesh.points[static_cast<std::size_t>(p)][2];
    if (height <= 0) continue;
    for (Index& p : t) {
      Index& copy = lifted[static_cast<std::size_t>(p)];
      if (copy == kNone) {
        copy = static_cast<Index>(mesh.points.size());
        mesh.points.push_back(mesh.points[static_cast<std::size_t>(p)] + Vec3(0, 0, kCrack));
      }
      p = copy;
    }
  }
  return mesh;
}

/// One triangle taken out; its longest side is some 0.16 long.
TriMesh pricked() {
  TriMesh mesh = test::icosphere(3);
  mesh.faceOf.clear();
  mesh.edgeOf.clear();
  mesh.vertexOf.clear();
  mesh.triangles.erase(mesh.triangles.begin() + 100);
  return mesh;
}

SurfaceDistance built(const TriMesh& mesh, double gap) {
  auto surface = SurfaceDistance::build(mesh, SignRule::Topology, gap);
  EXPECT_TRUE(surface.has_value());
  return std::move(*surface);
}

TEST(Gaps, ClosedWhenTheyAreNarrower) {
  const SurfaceDistance cracked = built(crackedSphere(), 1.5 * kCrack);
  EXPECT_TRUE(cracked.closed());
  EXPECT_FALSE(cracked.watertight());
  EXPECT_FALSE(built(crackedSphere(), 0.5 * kCrack).closed());
  EXPECT_FALSE(built(crackedSphere(), 0).closed());
  EXPECT_TRUE(built(pricked(), 0.2).closed());
  EXPECT_FALSE(built(pricked(), 0.02).closed());
  EXPECT_TRUE(built(test::icosphere(2), 0.2).watertight());
}

// Their free edges are short and near each other, but none faces another one.
TEST(Gaps, RimsOfOpeningsAreNone) {
  EXPECT_FALSE(built(test::sheet(20), 0.3).closed());
  EXPECT_FALSE(built(test::sheet(4), 10).closed());  // smaller than the gap as a whole
  TriMesh cup = test::icosphere(4);
  std::erase_if(cup.triangles,
                [&](const auto& t) { return cup.points[static_cast<std::size_t>(t[0])][2] > 0.8; });
  cup.faceOf.clear();
  cup.edgeOf.clear();
  EXPECT_FALSE(built(cup, 0.3).closed());
}

TEST(Gaps, SignsAreRightBesideThem) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const TriMesh& mesh : {crackedSphere(), pricked()}) {
    const SurfaceDistance surface = built(mesh, 0.2);
    int inside = 0;
    for (int i = 0; i < 20'000; ++i) {
      const Vec3 x = 1.3 * Vec3(unit(random), unit(random), unit(random));
      const double r = x.norm();
      if (std::abs(r - 1) < 1.5 * kCrack) continue;
      const FootPoint foot = surface.foot(x);
      EXPECT_EQ(foot.phi() < 0, r < 1) << x.transpose();
      EXPECT_FALSE(foot.beyondBorder);
      inside += r < 1 ? 1 : 0;
    }
    EXPECT_GT(inside, 1000);
  }
}

TEST(Gaps, FieldHoldsNodesOnBothSidesOfThem) {
  const SurfaceDistance surface = built(crackedSphere(), 0.1);
  const auto field =
      solveDistanceField(surface, {.spacing = 0.05, .bandMin = -0.2, .bandMax = 0.2});
  ASSERT_TRUE(field.has_value()) << field.error().message;
  std::int64_t nodes = 0;
  field->forNodes([&](const GridIndex& node, double phi, Index triangle) {
    const double r = field->position(node).norm();
    ASSERT_NE(triangle, kNone);
    ++nodes;
    if (std::abs(r - 1) > 1.5 * kCrack) {
      EXPECT_EQ(phi < 0, r < 1);
    }
  });
  // The volume of the shell over that of a cell.
  EXPECT_NEAR(static_cast<double>(nodes), 4 * M_PI * 0.4 / std::pow(0.05, 3), 1500);
}

TEST(Gaps, FrontPassesOverThem) {
  for (const TriMesh& mesh : {crackedSphere(), pricked()}) {
    for (const double level : {0.2, -0.2}) {
      const auto front = isoSurface(built(mesh, 0.2), {.level = level});
      ASSERT_TRUE(front.has_value()) << front.error().message;
      EXPECT_TRUE(diagnose(front->mesh).closedManifold());
      for (const Vec3& p : front->mesh.points) EXPECT_NEAR(p.norm(), 1 + level, 1.5 * kCrack);
    }
  }
}

}  // namespace
}  // namespace phront
