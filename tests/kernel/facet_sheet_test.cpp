// Sheets whose offset is known, as facets.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "facets.h"
#include "meshes.h"
#include "phront/facet.h"

namespace phront {
namespace {

SurfaceDistance distanceTo(TriMesh mesh, SignRule rule = SignRule::Topology) {
  return *SurfaceDistance::build(std::move(mesh), rule);
}

/// A profile in the xz plane drawn out along y from 0 to 1; normals to the left of the profile.
TriMesh drawn(const std::vector<std::array<double, 2>>& profile) {
  TriMesh mesh;
  for (const auto& [x, z] : profile) {
    mesh.points.emplace_back(x, 0, z);
    mesh.points.emplace_back(x, 1, z);
  }
  for (std::size_t k = 0; k + 1 < profile.size(); ++k) {
    const auto i = static_cast<Index>(2 * k);
    mesh.triangles.push_back({i, i + 2, i + 3});
    mesh.triangles.push_back({i, i + 3, i + 1});
    mesh.faceOf.insert(mesh.faceOf.end(), 2, static_cast<Index>(k));
  }
  return mesh;
}

/// Around the origin, from +x by `angle`; its normals point inwards.
TriMesh arc(double radius, double angle, int count) {
  std::vector<std::array<double, 2>> profile;
  for (int k = 0; k <= count; ++k)
    profile.push_back({radius * std::cos(angle * k / count), radius * std::sin(angle * k / count)});
  TriMesh mesh = drawn(profile);
  mesh.faceOf.assign(mesh.triangles.size(), 0);
  return mesh;
}

FacetedSurface facetsOf(const TriMesh& mesh, double distance, double spacing, double tolerance,
                        std::vector<std::optional<Plane>> planes = {}) {
  const SurfaceDistance sheet = distanceTo(mesh);
  const SurfaceDistance around = distanceTo(mesh, SignRule::Unsigned);
  IsoSurfaceOptions options;
  options.level = std::abs(distance);
  options.spacing = spacing;
  const auto wrap = isoSurface(around, options);
  EXPECT_TRUE(wrap) << wrap.error().message;
  if (planes.empty()) planes.resize(mesh.triangles.size());
  const auto facets = facetSheet(sheet, around, *wrap, distance,
                                 {.tolerance = tolerance, .planeOfFace = std::move(planes)});
  EXPECT_TRUE(facets) << facets.error().message;
  return facets ? *facets : FacetedSurface{};
}

/// No side is used twice in a direction; those used in one only make closed loops: their number.
int borderLoops(const FacetedSurface& facets) {
  std::set<std::pair<Index, Index>> sides;
  for (const FacetPolygon& polygon : facets.polygons) {
    for (const auto& loop : polygon.loops)
      for (std::size_t k = 0; k < loop.size(); ++k)
        EXPECT_TRUE(sides.insert({loop[k], loop[(k + 1) % loop.size()]}).second);
  }
  std::map<Index, Index> next;
  for (const auto& [a, b] : sides) EXPECT_TRUE(sides.contains({b, a}) || next.emplace(a, b).second);
  int loops = 0;
  for (; !next.empty(); ++loops) {
    const Index first = next.begin()->first;
    for (Index p = first; next.contains(p);) {
      const Index to = next.at(p);
      next.erase(p);
      p = to;
      EXPECT_TRUE(next.contains(p) || p == first);
    }
  }
  return loops;
}

TEST(UnsignedDistance, FrontWrapsASheet) {
  const SurfaceDistance around = distanceTo(drawn({{0, 0}, {1, 0}}), SignRule::Unsigned);
  EXPECT_TRUE(around.closed());
  EXPECT_FALSE(around.watertight());
  EXPECT_DOUBLE_EQ(around.signedDistance({0.5, 0.5, -0.25}), 0.25);
  EXPECT_DOUBLE_EQ(around.signedDistance({0.5, 0.5, 0.25}), 0.25);
  EXPECT_DOUBLE_EQ(around.signedDistance({1.25, 0.5, 0}), 0.25);
  EXPECT_FALSE(around.foot({1.25, 0.5, 0}).beyondBorder);
  IsoSurfaceOptions options;
  options.level = 0.25;
  const auto wrap = isoSurface(around, options);
  ASSERT_TRUE(wrap) << wrap.error().message;
  EXPECT_TRUE(diagnose(wrap->mesh).closedManifold());
  const double pi = std::numbers::pi;
  const double area = 2 + 4 * pi * 0.25 + 4 * pi * 0.25 * 0.25;
  EXPECT_NEAR(phront::area(wrap->mesh), area, 0.01 * area);
}

TEST(FacetSheet, APlaneMovesAsOnePolygon) {
  const TriMesh square = drawn({{0, 0}, {1, 0}});  // normals up
  for (const double d : {0.3, -0.3}) {
    const FacetedSurface facets = facetsOf(square, d, 0.07, 0.003, {Plane{Vec3::UnitZ(), 0.0}});
    ASSERT_EQ(facets.polygons.size(), 1U);
    EXPECT_EQ(borderLoops(facets), 1);
    const Vec3 area = test::areaVectorOf(facets, facets.polygons[0]);
    EXPECT_NEAR(area.z(), 1, 1e-3);
    EXPECT_NEAR(facets.polygons[0].plane.normal.z(), 1, 1e-12);
    EXPECT_NEAR(facets.polygons[0].plane.offset, d, 1e-12);
    for (const Vec3& p : facets.points) EXPECT_NEAR(p.z(), d, 1e-9);
  }
}

TEST(FacetSheet, BothSidesOfAnArc) {
  const double pi = std::numbers::pi;
  const TriMesh half = arc(1, pi, 200);
  for (const double d : {0.3, -0.3}) {
    const FacetedSurface facets = facetsOf(half, d, 0.06, 0.004);
    EXPECT_EQ(borderLoops(facets), 1);
    EXPECT_NEAR(test::areaOf(facets), pi * (1 - d), 0.01 * pi);
    EXPECT_LT(facets.p99Deviation, 0.004);
    for (const FacetPolygon& polygon : facets.polygons) {
      const Vec3& p = facets.points[polygon.loops[0][0]];
      EXPECT_LT(test::areaVectorOf(facets, polygon).dot(Vec3(p.x(), 0, p.z())), 0);  // as the sheet
    }
  }
}

TEST(FacetSheet, NothingIsLeftBeyondTheCurvature) {
  // Every point inside is nearer to another part of the arc, or its foot is on a free edge.
  EXPECT_TRUE(facetsOf(arc(1, std::numbers::pi, 200), 1.2, 0.06, 0.01).polygons.empty());
}

TEST(FacetSheet, AnAngleIsCutInsideAndRoundedOutside) {
  const TriMesh angle = drawn({{0, 1}, {0, 0}, {1, 0}});  // normals into the angle: +x and +z
  const double d = 0.25;
  const FacetedSurface inside = facetsOf(angle, d, 0.05, 0.002);
  EXPECT_EQ(borderLoops(inside), 1);
  EXPECT_NEAR(test::areaOf(inside), 2 * (1 - d), 0.01);
  const FacetedSurface outside = facetsOf(angle, -d, 0.05, 0.002);
  EXPECT_EQ(borderLoops(outside), 1);
  EXPECT_NEAR(test::areaOf(outside), 2 + d * std::numbers::pi / 2, 0.01);
}

TEST(FacetSheet, TwoSheetsFacingEachOtherMeetInTheMiddle) {
  // A slot of width 0.4, with normals into it: at 0.25 the fronts have passed one another.
  TriMesh mesh = drawn({{0, 0}, {1, 0}});
  const auto first = static_cast<Index>(mesh.points.size());
  for (const Vec3& p : std::vector<Vec3>(mesh.points)) mesh.points.push_back(p + Vec3(0, 0, 0.4));
  for (const auto& t : std::vector(mesh.triangles)) {
    mesh.triangles.push_back({t[0] + first, t[2] + first, t[1] + first});
    mesh.faceOf.push_back(1);
  }
  EXPECT_TRUE(facetsOf(mesh, 0.25, 0.05, 0.002).polygons.empty());
  EXPECT_NEAR(test::areaOf(facetsOf(mesh, 0.15, 0.05, 0.002)), 2, 0.01);
  EXPECT_NEAR(test::areaOf(facetsOf(mesh, -0.25, 0.05, 0.002)), 2, 0.01);
}

}  // namespace
}  // namespace phront
