#include "phront/advect.h"

#include <gtest/gtest.h>

#include <cmath>

#include "meshes.h"

namespace phront {
namespace {

SurfaceDistance built(TriMesh mesh) {
  auto surface = SurfaceDistance::build(std::move(mesh));
  EXPECT_TRUE(surface.has_value()) << surface.error().message;
  return std::move(*surface);
}

AdvectResult moved(const SurfaceDistance& surface, const std::vector<Vec3>& start,
                   const std::vector<Vec3>& normals, double distance) {
  auto result = advectPoints(surface, start, normals, {.distance = distance});
  EXPECT_TRUE(result.has_value()) << result.error().message;
  return std::move(*result);
}

AdvectResult movedMesh(const SurfaceDistance& surface, double distance) {
  auto result = advectMesh(surface, {.distance = distance});
  EXPECT_TRUE(result.has_value()) << result.error().message;
  return std::move(*result);
}

TEST(AdvectPoints, PlaneMovesStraight) {
  const SurfaceDistance surface = built(test::sheet(4));
  const std::vector<Vec3> start{Vec3(0.3, 0.4, 0), Vec3(0.5, 0.5, 0), Vec3(0, 0.3, 0),
                                Vec3(1, 1, 0)};
  const std::vector<Vec3> normals(4, Vec3(0, 0, 2));  // made unit inside
  for (const double d : {0.7, -0.2}) {
    const AdvectResult result = moved(surface, start, normals, d);
    for (std::size_t i = 0; i < start.size(); ++i) {
      EXPECT_EQ(result.status[i], AdvectStatus::Arrived);
      EXPECT_EQ(result.points[i], start[i] + Vec3(0, 0, d));
      EXPECT_DOUBLE_EQ(result.travelled[i], std::abs(d));
    }
  }
}

TEST(AdvectPoints, BoxCornersAndEdgesStayTheFeetOfTheirOffset) {
  const SurfaceDistance surface = built(test::box(Vec3(0, 0, 0), Vec3(1, 1, 1)));
  const std::vector<Vec3> start{Vec3(1, 1, 1), Vec3(1, 0.4, 1), Vec3(0, 0, 0.2)};
  const std::vector<Vec3> normals{Vec3(1, 2, 3), Vec3(1, 0, 1), Vec3(-1, -2, 0)};
  const AdvectResult result = moved(surface, start, normals, 0.5);
  for (std::size_t i = 0; i < start.size(); ++i) {
    EXPECT_EQ(result.status[i], AdvectStatus::Arrived);
    EXPECT_LT((result.points[i] - start[i] - 0.5 * normals[i].normalized()).norm(), 1e-15);
    EXPECT_EQ(surface.foot(result.points[i]).point, start[i]);
  }
  // Inwards a corner lies on the medial axis: it collides where it stands.
  const AdvectResult inward = moved(surface, {Vec3(1, 1, 1)}, {Vec3(1, 1, 1)}, -0.2);
  EXPECT_EQ(inward.status[0], AdvectStatus::Collided);
  EXPECT_LT((inward.points[0] - Vec3(1, 1, 1)).norm(), 1e-11);
}

TEST(AdvectPoints, FrontsOfAnLShapeCollideOnTheBisector) {
  const SurfaceDistance surface = built(test::lShape());
  // In the notch the walls x = 1 (y > 1) and y = 1 (x > 1) face one another.
  const std::vector<Vec3> start{Vec3(1.25, 1, 0.5), Vec3(1, 1.6, 0.5), Vec3(1.9, 1, 0.5)};
  const std::vector<Vec3> normals{Vec3(0, 1, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  const AdvectResult result = moved(surface, start, normals, 0.75);
  const std::vector<Vec3> expected{Vec3(1.25, 1.25, 0.5), Vec3(1.6, 1.6, 0.5),
                                   Vec3(1.9, 1.75, 0.5)};
  const std::vector<AdvectStatus> status{AdvectStatus::Collided, AdvectStatus::Collided,
                                         AdvectStatus::Arrived};
  for (std::size_t i = 0; i < start.size(); ++i) {
    EXPECT_EQ(result.status[i], status[i]);
    EXPECT_LT((result.points[i] - expected[i]).norm(), 1e-11);  // 1e-12 of the distance, twice over
    EXPECT_NEAR(result.travelled[i], std::abs(surface.signedDistance(result.points[i])), 1e-15);
  }
}

TEST(AdvectPoints, OpposingWallsMeetHalfway) {
  const SurfaceDistance surface = built(test::box(Vec3(0, 0, 0), Vec3(10, 10, 1)));
  const AdvectResult result =
      moved(surface, {Vec3(4, 5, 1), Vec3(4, 5, 0)}, {Vec3(0, 0, 1), Vec3(0, 0, -1)}, -3);
  for (const Vec3& p : result.points) EXPECT_LT((p - Vec3(4, 5, 0.5)).norm(), 1e-11);
  EXPECT_EQ(result.status[0], AdvectStatus::Collided);
  EXPECT_NEAR(result.travelled[1], 0.5, 1e-11);
}

TEST(AdvectMesh, SphereGrowsAndShrinksToASphere) {
  const SurfaceDistance surface = built(test::sphere(1, 4));
  for (const double d : {0.5, -0.5}) {
    const AdvectResult result = movedMesh(surface, d);
    ASSERT_EQ(result.points.size(), surface.mesh().points.size());
    for (std::size_t i = 0; i < result.points.size(); ++i) {
      EXPECT_EQ(result.status[i], AdvectStatus::Arrived);
      EXPECT_NEAR(surface.signedDistance(result.points[i]), d, 1e-13);
      // Facets of the inscribed mesh lie up to 0.00388 below the sphere (from their planes).
      EXPECT_NEAR(result.points[i].norm(), 1 + d, 0.0039);
      EXPECT_LT(result.points[i].cross(surface.mesh().points[i]).norm(),
                0.01);  // radial to a tenth of a side: pseudonormals of uneven rings lean a little
    }
  }
}

// The paths pass the centre at the distance by which the pseudonormals lean off the radius (uneven
// rings), and stop along the path as exactly as the facets know the sphere.
TEST(AdvectMesh, SphereStopsAtItsCentre) {
  const SurfaceDistance surface = built(test::sphere(1, 3));
  const AdvectResult result = movedMesh(surface, -1.5);
  ASSERT_FALSE(result.points.empty());
  for (std::size_t i = 0; i < result.points.size(); ++i) {
    const Vec3& radius = surface.mesh().points[i];  // of length 1
    const Vec3 normal = surface.gradient(radius, surface.foot(radius));
    const double along = result.points[i].dot(radius);
    const double across = (result.points[i] - along * radius).norm();
    EXPECT_EQ(result.status[i], AdvectStatus::Collided);
    EXPECT_LT(std::abs(along), 0.0153);  // largest sag, computed from the planes of the triangles
    // The way is one radius, give or take the sag.
    EXPECT_LT(across, 1.0153 * normal.cross(radius).norm() + 1e-12);
  }
}

TEST(AdvectMesh, BoxBecomesTheSmallerBox) {
  const SurfaceDistance surface = built(test::box(Vec3(0, 0, 0), Vec3(1, 2, 3)));
  const AdvectResult result = movedMesh(surface, -0.25);
  for (std::size_t i = 0; i < result.points.size(); ++i) {
    const Vec3& p = surface.mesh().points[i];
    Vec3 expected = p;
    for (int axis = 0; axis < 3; ++axis) expected[axis] += p[axis] > 0 ? -0.25 : 0.25;
    EXPECT_EQ(result.status[i], AdvectStatus::Arrived);
    EXPECT_NEAR(surface.signedDistance(result.points[i]), -0.25, 1e-14);
    // Corners walk along their pseudonormal, the diagonal: three right angles weigh alike.
    EXPECT_LT((result.points[i] - expected).norm(), 1e-12);
  }
  // Beyond half the shortest side nothing is left: all stop on the medial axis.
  const AdvectResult gone = movedMesh(surface, -0.75);
  for (std::size_t i = 0; i < gone.points.size(); ++i) {
    EXPECT_EQ(gone.status[i], AdvectStatus::Collided);
    EXPECT_NEAR(gone.travelled[i], 0.5, 1e-11);
    EXPECT_NEAR(gone.points[i][0], 0.5, 1e-11);
  }
}

TEST(AdvectMesh, SameBitsForAnyNumberOfThreads) {
  const SurfaceDistance surface = built(test::torus(2, 0.6, 24, 12));
  const auto one = advectMesh(surface, {.distance = -0.8, .threads = 1});
  ASSERT_TRUE(one.has_value());
  for (const int threads : {2, 4}) {
    const auto other = advectMesh(surface, {.distance = -0.8, .threads = threads});
    ASSERT_TRUE(other.has_value());
    EXPECT_EQ(other->points, one->points);
    EXPECT_EQ(other->travelled, one->travelled);
    EXPECT_EQ(other->status, one->status);
  }
}

TEST(AdvectPoints, RefusesBadInput) {
  const SurfaceDistance surface = built(test::sheet(2));
  const std::vector<Vec3> one{Vec3(0.5, 0.5, 0)};
  const std::vector<Vec3> up{Vec3(0, 0, 1)};
  const std::vector<Vec3> zero{Vec3(0, 0, 0)};
  const std::vector<Vec3> nan{Vec3(0, 0, std::nan(""))};
  const std::vector<Vec3> far{Vec3(1e200, 0, 0)};  // its square overflows
  for (const auto& result :
       {advectPoints(surface, far, up, {.distance = 1}),
        advectPoints(surface, one, up, {.distance = 1e200}),
        advectPoints(surface, one, up, {.distance = 0}),
        advectPoints(surface, one, up, {.distance = std::nan("")}),
        advectPoints(surface, one, {}, {.distance = 1}),
        advectPoints(surface, one, zero, {.distance = 1}),
        advectPoints(surface, nan, up, {.distance = 1}), advectMesh(surface, {.distance = 0})}) {
    ASSERT_FALSE(result.has_value());
    EXPECT_EQ(result.error().code, ErrorCode::InvalidArgument);
  }
  const Progress never([](double, std::string_view) { return false; });
  EXPECT_EQ(advectMesh(surface, {.distance = 1}, never).error().code, ErrorCode::Cancelled);
}

}  // namespace
}  // namespace phront
