// Where do advected points land? phi at a landing point cannot tell: a point that slipped along the
// front has the right phi too. A seed inside a triangle lands at P + d n of that triangle while P
// is its only foot there; if the front of another triangle comes first, it stops on the way, where
// both are as far. Outside a convex solid nothing comes first.
#include <gtest/gtest.h>

#include <cstdio>
#include <random>

#include "phront/advect.h"
#include "random_meshes.h"
#include "reference_distance.h"

namespace phront {
namespace {

constexpr double kTolerance = 1e-6;  // of |d|, asked of positions
constexpr double kRoundOff =
    1e-12;  // of |d|: what exact positions reach, and feet are told apart by

struct Seeds {
  std::vector<Vec3> points;
  std::vector<Vec3> normals;
  void add(const Vec3& point, const Vec3& normal) {
    points.push_back(point);
    normals.push_back(normal);
  }
};

std::array<Vec3, 3> cornersOf(const TriMesh& mesh, std::size_t t) {
  std::array<Vec3, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    corners[k] = mesh.points[static_cast<std::size_t>(mesh.triangles[t][k])];
  }
  return corners;
}

Vec3 normalOf(const std::array<Vec3, 3>& c) {
  return (c[1] - c[0]).cross(c[2] - c[0]).normalized();
}

/// In every triangle: one seed anywhere, and one near each side, 1e-1 to 1e-9 of the way from it to
/// the opposite corner.
Seeds seedsOn(const TriMesh& mesh) {
  std::mt19937_64 rng(3);
  Seeds seeds;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto corners = cornersOf(mesh, t);
    const Vec3 normal = normalOf(corners);
    const Vec3 w(test::uniform(rng, 0.1, 1), test::uniform(rng, 0.1, 1),
                 test::uniform(rng, 0.1, 1));
    seeds.add((w[0] * corners[0] + w[1] * corners[1] + w[2] * corners[2]) / w.sum(), normal);
    for (std::size_t k = 0; k < 3; ++k) {
      const double along = test::uniform(rng, 0.1, 0.9);
      const double in = std::pow(10, test::uniform(rng, -9, -1));
      const Vec3 side = corners[k] + along * (corners[(k + 1) % 3] - corners[k]);
      seeds.add(side + in * (corners[(k + 2) % 3] - side), normal);
    }
  }
  return seeds;
}

AdvectResult moved(const TriMesh& mesh, const Seeds& seeds, double distance) {
  const auto surface = SurfaceDistance::build(mesh);
  EXPECT_TRUE(surface.has_value()) << surface.error().message;
  auto result = advectPoints(*surface, seeds.points, seeds.normals, {.distance = distance});
  EXPECT_TRUE(result.has_value()) << result.error().message;
  return std::move(*result);
}

/// All seeds must arrive at P + d n; returns the largest distance from there.
void expectStraight(const char* name, const TriMesh& mesh, const Seeds& seeds, double distance) {
  SCOPED_TRACE(name);
  ASSERT_FALSE(seeds.points.empty());
  const AdvectResult result = moved(mesh, seeds, distance);
  double largest = 0;
  std::size_t stopped = 0;
  for (std::size_t i = 0; i < seeds.points.size(); ++i) {
    const Vec3 expected = seeds.points[i] + distance * seeds.normals[i];
    largest = std::max(largest, (result.points[i] - expected).norm() / std::abs(distance));
    stopped += result.status[i] == AdvectStatus::Arrived ? 0 : 1;
  }
  std::printf("%s by %g: %zu seeds, largest slip %.3g of the distance\n", name, distance,
              seeds.points.size(), largest);
  EXPECT_LE(largest, kTolerance);
  EXPECT_EQ(stopped, 0U);
}

/// A prism of 64 sides whose mantle is one face, as the tessellation of a cylinder has it.
TriMesh cylinder() {
  TriMesh mesh = test::regularPrism(64, 1, 2);
  for (Index& face : mesh.faceOf) face = std::max(face, Index{63}) - 63;
  mesh.edgeOf.clear();
  mesh.vertexOf.clear();
  return mesh;
}

TEST(AdvectPosition, OutsideAConvexSolidEverySeedLandsOnItsNormal) {
  const TriMesh box = test::box(Vec3(0, 0, 0), Vec3(1, 2, 3));
  const TriMesh ball = test::icosphere(4);
  for (const double d : {1e-3, 0.1, 2.5}) {
    expectStraight("box", box, seedsOn(box), d);
    expectStraight("cylinder", cylinder(), seedsOn(cylinder()), d);
    expectStraight("sphere", ball, seedsOn(ball), d);
  }
}

// Inwards the bisector of the two faces at an edge stops seeds nearer to it than d.
TEST(AdvectPosition, InsideABoxSeedsLandOnTheirNormalOrOnTheBisector) {
  const Vec3 size(1, 2, 3);
  const TriMesh box = test::box(Vec3(0, 0, 0), size);
  const Seeds seeds = seedsOn(box);
  const double d = 0.2;
  const AdvectResult result = moved(box, seeds, -d);
  int arrived = 0;
  int collided = 0;
  for (std::size_t i = 0; i < seeds.points.size(); ++i) {
    const Vec3& p = seeds.points[i];
    double toOthers = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(seeds.normals[i][axis]) > 0.5) continue;
      toOthers = std::min({toOthers, p[axis], size[axis] - p[axis]});
    }
    const double way = std::min(d, toOthers);
    EXPECT_LE((result.points[i] - (p - way * seeds.normals[i])).norm(), kTolerance * d);
    EXPECT_EQ(result.status[i], toOthers < d ? AdvectStatus::Collided : AdvectStatus::Arrived);
    ++(toOthers < d ? collided : arrived);
  }
  EXPECT_GT(arrived, 5);
  EXPECT_GT(collided, 20);
}

// A curved face that ends at a sharp edge: the middle lines of its facets see nothing but the caps.
TEST(AdvectPosition, InsideACylinderSeedsAtTheRimStopOnTheBisector) {
  const TriMesh mesh = cylinder();
  const double d = 0.2;
  const Vec3 normal = normalOf(cornersOf(mesh, 0));
  const Vec3 middle = (mesh.points[0] + mesh.points[1]) / 2;
  Seeds seeds;
  std::vector<double> toCap;
  for (const double share :
       {0.01, 0.5, 0.9, 0.99, 0.995, 0.999, 0.9999, 1.0001, 1.001, 1.01, 2.0}) {
    toCap.push_back(share * d);
    seeds.add(middle + Vec3(0, 0, share * d), normal);
  }
  const AdvectResult result = moved(mesh, seeds, -d);
  for (std::size_t i = 0; i < toCap.size(); ++i) {
    SCOPED_TRACE(toCap[i]);
    const Vec3 expected = seeds.points[i] - std::min(d, toCap[i]) * normal;
    EXPECT_LE((result.points[i] - expected).norm(), kTolerance * d);
    EXPECT_EQ(result.status[i], toCap[i] < d ? AdvectStatus::Collided : AdvectStatus::Arrived);
    EXPECT_NEAR(result.travelled[i], std::min(d, toCap[i]), kTolerance * d);
  }
}

// On curved faces the facets meet at every side: a seed lands on its normal where a loop over all
// triangles finds nothing nearer to that place than the seed.
TEST(AdvectPosition, InsideCurvedFacesSeedsLandOnTheirNormalWhereTheyAreTheOnlyFoot) {
  for (const auto& [name, mesh] :
       {std::pair{"cylinder", cylinder()}, {"sphere", test::icosphere(3)}}) {
    const test::ReferenceDistance reference(mesh);
    for (const double d : {1e-3, 0.1, 0.5}) {
      const Seeds all = seedsOn(mesh);
      Seeds alone;
      for (std::size_t i = 0; i < all.points.size(); ++i) {
        const Vec3 there = all.points[i] - d * all.normals[i];
        const bool onlyFoot = reference.distance(there) >= d * (1 - kRoundOff);
        if (onlyFoot) alone.add(all.points[i], all.normals[i]);
      }
      EXPECT_GT(4 * alone.points.size(), all.points.size() / 4);
      expectStraight(name, mesh, alone, -d);
    }
  }
}

}  // namespace
}  // namespace phront
