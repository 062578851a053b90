#include "phront/tri_mesh.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "meshes.h"

namespace phront {
namespace {

TEST(TriMesh, BoxHasItsVolumeAreaAndBounds) {
  const TriMesh mesh = test::box(Vec3(1, 2, 3), Vec3(2, 4, 6));
  EXPECT_DOUBLE_EQ(signedVolume(mesh), 6);
  EXPECT_DOUBLE_EQ(area(mesh), 22);
  EXPECT_EQ(boundingBox(mesh).min(), Vec3(1, 2, 3));
  EXPECT_EQ(boundingBox(mesh).max(), Vec3(2, 4, 6));
}

TEST(TriMesh, SphereVolumeConvergesAtSecondOrder) {
  const double exact = 4 * std::numbers::pi / 3;
  const double coarse = exact - signedVolume(test::sphere(1, 3));
  const double fine = exact - signedVolume(test::sphere(1, 4));
  EXPECT_GT(fine, 0);                  // inscribed
  EXPECT_NEAR(coarse / fine, 4, 0.1);  // O(h^2); next term O(h^4)
}

TEST(TriMesh, FarFromTheOriginVolumeKeepsItsDigits) {
  const Vec3 far(1e6, -1e6, 1e6);
  // Coordinates are rounded to 1e-10 there: the volume can be no better.
  EXPECT_NEAR(signedVolume(test::box(far, far + Vec3(1, 1, 1))), 1, 1e-9);
}

TEST(Diagnose, ClosedShapesAreClosedManifolds) {
  for (const TriMesh& mesh : {test::box(Vec3(0, 0, 0), Vec3(1, 1, 1)), test::lShape(),
                              test::sphere(1, 2), test::torus(2, 0.5, 16, 8)}) {
    const MeshDiagnostics d = diagnose(mesh);
    EXPECT_TRUE(d.closedManifold());
    EXPECT_EQ(d.components, 1);
    EXPECT_EQ(d.degenerateTriangles, 0);
  }
}

TEST(Diagnose, CountsEachFault) {
  TriMesh mesh = test::box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  mesh.triangles.pop_back();
  EXPECT_EQ(diagnose(mesh).freeEdges, 3);
  EXPECT_FALSE(diagnose(mesh).closedManifold());

  mesh = test::box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
  EXPECT_EQ(diagnose(mesh).misorientedEdges, 3);

  mesh.triangles[0] = {0, 1, 99};
  EXPECT_EQ(diagnose(mesh).badIndices, 1);
  mesh.triangles[0] = {0, 1, 1};
  EXPECT_EQ(diagnose(mesh).degenerateTriangles, 1);
  mesh.points[3][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(diagnose(mesh).nonFinitePoints, 1);
  EXPECT_EQ(diagnose(TriMesh{}).components, 0);
}

// Two tetrahedra that share one point or one edge.
TEST(Diagnose, FindsTouchingSolids) {
  TriMesh mesh;
  mesh.points = {Vec3(0, 0, 0),  Vec3(1, 0, 0),  Vec3(0, 1, 0), Vec3(0, 0, 1),
                 Vec3(-1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, -1)};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3},
                    {0, 4, 5}, {0, 6, 4}, {4, 6, 5}, {5, 6, 0}};
  EXPECT_EQ(diagnose(mesh).nonManifoldPoints, 1);
  EXPECT_EQ(diagnose(mesh).nonManifoldEdges, 0);
  EXPECT_EQ(diagnose(mesh).components, 2);
  for (auto& t : mesh.triangles) {
    for (Index& p : t) p = p == 6 ? 3 : p;  // share the edge 0-3 as well
  }
  EXPECT_EQ(diagnose(mesh).nonManifoldEdges, 1);
}

TEST(Components, AreNumberedByTheirFirstTriangle) {
  TriMesh mesh = test::box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  const TriMesh other = test::box(Vec3(5, 0, 0), Vec3(6, 1, 1));
  for (const Vec3& p : other.points) mesh.points.push_back(p);
  for (const auto& t : other.triangles) mesh.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  const Components parts = connectedComponents(mesh);
  ASSERT_EQ(parts.count, 2);
  for (std::size_t t = 0; t < 24; ++t) EXPECT_EQ(parts.ofTriangle[t], t < 12 ? 0 : 1);
}

TEST(Orient, TurnsTheSmallerAreaAndItsLabels) {
  const TriMesh sound = test::lShape();
  TriMesh mesh = sound;
  for (const std::size_t t : {0U, 1U, 5U}) {
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    std::swap(mesh.edgeOf[3 * t], mesh.edgeOf[3 * t + 2]);
  }
  const OrientedMesh mended = orient(mesh);
  EXPECT_EQ(mended.turned, 3);
  EXPECT_EQ(mended.mesh.triangles, sound.triangles);
  EXPECT_EQ(mended.mesh.edgeOf, sound.edgeOf);
}

TEST(Orient, LeavesWhatAgrees) {
  TriMesh mesh = test::torus(2, 0.5, 16, 8);
  EXPECT_EQ(orient(mesh).turned, 0);
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);  // inside out, but at one
  const OrientedMesh same = orient(mesh);
  EXPECT_EQ(same.turned, 0);
  EXPECT_EQ(same.mesh.triangles, mesh.triangles);
}

// Both parts are mended on their own; a seam stays on a one-sided strip.
TEST(Orient, TakesPartsOneByOneAndCannotMendAMoebiusStrip) {
  TriMesh mesh = test::sphere(1, 1);
  test::append(mesh, test::sphere(1, 1, Vec3(5, 0, 0)), true);
  std::swap(mesh.triangles[3][0], mesh.triangles[3][1]);
  std::swap(mesh.triangles[40][0], mesh.triangles[40][1]);
  EXPECT_EQ(orient(mesh).turned, 2);
  EXPECT_EQ(diagnose(orient(mesh).mesh).misorientedEdges, 0);

  TriMesh strip;
  constexpr Index kSteps = 12;
  for (Index i = 0; i < kSteps; ++i) {
    const double u = 2 * std::numbers::pi * i / kSteps;
    const Vec3 radius(std::cos(u), std::sin(u), 0);
    const Vec3 across = std::cos(u / 2) * radius + std::sin(u / 2) * Vec3(0, 0, 1);
    strip.points.push_back(radius + 0.3 * across);
    strip.points.push_back(radius - 0.3 * across);
  }
  for (Index i = 0; i < kSteps; ++i) {
    const bool last = i + 1 == kSteps;  // half a turn on, the rims have changed places
    const Index a = last ? 1 : 2 * i + 2;
    const Index b = last ? 0 : 2 * i + 3;
    strip.triangles.push_back({2 * i, a, b});
    strip.triangles.push_back({2 * i, b, 2 * i + 1});
  }
  EXPECT_EQ(diagnose(orient(strip).mesh).misorientedEdges, 1);
}

TEST(Weld, RestoresSharedPointsAndLabels) {
  const TriMesh mesh = test::lShape();
  TriMesh soup;
  soup.faceOf = mesh.faceOf;
  soup.edgeOf = mesh.edgeOf;
  for (const auto& t : mesh.triangles) {
    const auto n = static_cast<Index>(soup.points.size());
    soup.triangles.push_back({n, n + 1, n + 2});
    for (const Index p : t) {
      soup.points.push_back(mesh.points[static_cast<std::size_t>(p)]);
      soup.vertexOf.push_back(mesh.vertexOf[static_cast<std::size_t>(p)]);
    }
  }
  soup.points[0][2] = -0.0;  // equal to 0, other bits
  EXPECT_EQ(diagnose(soup).components, static_cast<Index>(mesh.triangles.size()));
  const TriMesh welded = weld(soup);
  EXPECT_EQ(welded.points.size(), mesh.points.size());
  EXPECT_TRUE(diagnose(welded).closedManifold());
  EXPECT_EQ(welded.faceOf, mesh.faceOf);
  EXPECT_EQ(welded.edgeOf, mesh.edgeOf);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto from = static_cast<std::size_t>(mesh.triangles[t][k]);
      const auto to = static_cast<std::size_t>(welded.triangles[t][k]);
      EXPECT_EQ(welded.points[to], mesh.points[from]);
      EXPECT_EQ(welded.vertexOf[to], mesh.vertexOf[from]);
    }
  }
}

TEST(Weld, DropsTrianglesThatCollapse) {
  TriMesh mesh = test::box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  mesh.points.push_back(mesh.points[0]);
  mesh.triangles.push_back({0, 1, 8});
  mesh.faceOf.push_back(7);
  mesh.edgeOf.insert(mesh.edgeOf.end(), 3, kNone);
  mesh.vertexOf.push_back(kNone);
  const TriMesh welded = weld(mesh);
  EXPECT_EQ(welded.triangles.size(), 12U);
  EXPECT_EQ(welded.faceOf.size(), 12U);
  EXPECT_EQ(welded.edgeOf.size(), 36U);
}

}  // namespace
}  // namespace phront
