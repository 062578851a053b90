#include "phront/surface_distance.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <random>
#include <utility>

#include "meshes.h"

namespace phront {
namespace {

SurfaceDistance built(TriMesh mesh) {
  auto surface = SurfaceDistance::build(std::move(mesh));
  EXPECT_TRUE(surface.has_value()) << surface.error().message;
  return std::move(*surface);
}

std::vector<Vec3> randomPoints(int count, double half, unsigned seed, const Vec3& centre) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-half, half);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double a = uniform(random);
    const double b = uniform(random);
    points.push_back(centre + Vec3(a, b, uniform(random)));
  }
  return points;
}

/// Nearest of all triangles by a loop; ties go to the smallest id.
FootPoint bruteForce(const SurfaceDistance& surface, const Vec3& x) {
  FootPoint best;
  for (std::size_t t = 0; t < surface.mesh().triangles.size(); ++t) {
    const FootPoint foot = surface.footOnTriangle(x, static_cast<Index>(t));
    if (foot.distance < best.distance) best = foot;
  }
  return best;
}

/// Distance to a triangle by ternary search over its two barycentric directions: slow, simple and
/// unlike the code under test.
double triangleDistanceBySearch(const std::array<Vec3, 3>& t, const Vec3& x) {
  auto along = [&](double u) {
    const Vec3 p = t[0] + u * (t[1] - t[0]);
    const Vec3 q = t[0] + u * (t[2] - t[0]);
    double lo = 0;
    double hi = 1;
    for (int i = 0; i < 100; ++i) {
      const double a = lo + (hi - lo) / 3;
      const double b = hi - (hi - lo) / 3;
      if ((p + a * (q - p) - x).norm() < (p + b * (q - p) - x).norm()) {
        hi = b;
      } else {
        lo = a;
      }
    }
    return (p + (lo + hi) / 2 * (q - p) - x).norm();
  };
  double lo = 0;
  double hi = 1;
  for (int i = 0; i < 100; ++i) {
    const double a = lo + (hi - lo) / 3;
    const double b = hi - (hi - lo) / 3;
    if (along(a) < along(b)) {
      hi = b;
    } else {
      lo = a;
    }
  }
  return along((lo + hi) / 2);
}

void expectSame(const FootPoint& a, const FootPoint& b) {
  EXPECT_EQ(a.triangle, b.triangle);
  EXPECT_EQ(a.point, b.point);
  EXPECT_EQ(a.distance, b.distance);
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.corner, b.corner);
  EXPECT_EQ(a.sign, b.sign);
  EXPECT_EQ(a.beyondBorder, b.beyondBorder);
}

double boxPhi(const Vec3& x, const Vec3& low, const Vec3& high) {
  const Vec3 q = (low - x).cwiseMax(x - high);
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

double lShapePhi(const Vec3& x) {
  // Inside, the union of two boxes is no simple minimum: near the concave edge the distance is to
  // the edge itself.
  const double a = boxPhi(x, Vec3(0, 0, 0), Vec3(2, 1, 1));
  const double b = boxPhi(x, Vec3(0, 0, 0), Vec3(1, 2, 1));
  if (a > 0 && b > 0) return std::min(a, b);
  const double walls = std::min({x[0], x[1], 2 - x[0], 2 - x[1], x[2], 1 - x[2]});
  const double right = x[1] <= 1 && x[0] >= 1 ? 1 - x[1] : std::hypot(1 - x[0], 1 - x[1]);
  const double notch = x[0] <= 1 && x[1] >= 1 ? 1 - x[0] : right;
  return -std::min(walls, notch);
}

TEST(FootOnTriangle, AgreesWithASearchOnRandomAndThinTriangles) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  auto point = [&] {
    const double a = uniform(random);
    const double b = uniform(random);
    return Vec3(a, b, uniform(random));
  };
  for (int i = 0; i < 300; ++i) {
    const Vec3 a = point();
    const Vec3 b = point();
    // Every other one is a sliver, down to 1e-9 high, some of them obtuse.
    const double thin = std::pow(10.0, -(i % 10));
    const Vec3 c = i % 2 == 0 ? point() : Vec3(a + 0.3 * (b - a) + thin * point());
    TriMesh mesh;
    mesh.points = {a, b, c};
    mesh.triangles = {{0, 1, 2}};
    const SurfaceDistance surface = built(mesh);
    const Vec3 x = 2 * point();
    const FootPoint foot = surface.footOnTriangle(x, 0);
    // The search stops at |du| ~ 1e-8 from the minimum: 1e-15 in distance, rounding 1e-15 more.
    EXPECT_NEAR(foot.distance, triangleDistanceBySearch({a, b, c}, x), 1e-13) << i;
    const Vec3 again = foot.barycentric[0] * a + foot.barycentric[1] * b + foot.barycentric[2] * c;
    EXPECT_LT((again - foot.point).norm(), 1e-14 / std::min(1.0, 10 * thin)) << i;
    EXPECT_NEAR(foot.barycentric.sum(), 1, 1e-14);
    EXPECT_GE(foot.barycentric.minCoeff(), 0);
  }
}

TEST(Foot, IsTheBruteForceAnswerOnRandomSoup) {
  std::mt19937 random(11);
  TriMesh mesh;
  mesh.points = randomPoints(400, 1, 3, Vec3::Zero());
  std::uniform_int_distribution<Index> pick(0, 399);
  while (mesh.triangles.size() < 600) {
    const Index a = pick(random);
    const Index b = pick(random);
    mesh.triangles.push_back({a, b, pick(random)});  // some collapse: allowed
  }
  const SurfaceDistance surface = built(mesh);
  for (const Vec3& x : randomPoints(2000, 2, 5, Vec3::Zero())) {
    const FootPoint foot = surface.foot(x);
    const FootPoint expected = bruteForce(surface, x);
    EXPECT_EQ(foot.triangle, expected.triangle);
    EXPECT_EQ(foot.point, expected.point);
  }
}

TEST(Foot, TiesGoToTheSmallestTriangle) {
  const SurfaceDistance surface = built(test::box(Vec3(-1, -1, -1), Vec3(1, 1, 1)));
  for (const Vec3& x : {Vec3(0, 0, 0), Vec3(2, 2, 2), Vec3(0, 2, 2), Vec3(0, 0, 2)}) {
    const FootPoint foot = surface.foot(x);
    EXPECT_EQ(foot.triangle, bruteForce(surface, x).triangle);
    for (Index t = 0; t < 12; ++t) expectSame(surface.footFrom(x, t), foot);
  }
}

TEST(FootFrom, GivesTheSameFromEveryStart) {
  const SurfaceDistance surface = built(test::torus(2, 0.7, 24, 12));
  const auto count = static_cast<Index>(surface.mesh().triangles.size());
  Index start = 0;
  for (const Vec3& x : randomPoints(3000, 3, 17, Vec3::Zero())) {
    start = (start + 97) % count;
    expectSame(surface.footFrom(x, start), surface.foot(x));
  }
  expectSame(surface.footFrom(Vec3(1, 1, 1), kNone), surface.foot(Vec3(1, 1, 1)));
}

TEST(Foot, ReachBoundsTheSearch) {
  const SurfaceDistance surface = built(test::box(Vec3(0, 0, 0), Vec3(1, 1, 1)));
  const Vec3 x(0.5, 0.5, 3);
  EXPECT_EQ(surface.foot(x, 1.99).triangle, kNone);
  EXPECT_EQ(surface.foot(x, 2).distance, 2);
  EXPECT_EQ(surface.footOnFace(x, 4, 2.5).triangle, kNone);  // the bottom, 3 away
  EXPECT_EQ(surface.footOnFace(x, 4, 3).point, Vec3(0.5, 0.5, 0));
  EXPECT_EQ(surface.footOnFace(x, 77).triangle, kNone);
  EXPECT_EQ(surface.footOnTriangle(x, -1).triangle, kNone);
}

TEST(Foot, NonFiniteQueriesFindNothing) {
  const SurfaceDistance surface = built(test::box(Vec3(0, 0, 0), Vec3(1, 1, 1)));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(surface.foot(Vec3(nan, 0, 0)).triangle, kNone);
  EXPECT_EQ(surface.footFrom(Vec3(0, nan, 0), 3).triangle, kNone);
  EXPECT_EQ(surface.footFrom(Vec3(1e300, 0, 0), 3).triangle, kNone);  // its square overflows
}

TEST(FootOnFace, SeesThatFaceAlone) {
  const SurfaceDistance surface = built(test::lShape());
  for (const Vec3& x : randomPoints(500, 2, 23, Vec3(1, 1, 0.5))) {
    for (Index face = 0; face < 8; ++face) {
      FootPoint best;
      for (std::size_t t = 0; t < surface.mesh().triangles.size(); ++t) {
        const FootPoint foot = surface.footOnTriangle(x, static_cast<Index>(t));
        if (surface.mesh().faceOf[t] == face && foot.distance < best.distance) best = foot;
      }
      const FootPoint foot = surface.footOnFace(x, face);
      EXPECT_EQ(foot.triangle, best.triangle);
      EXPECT_EQ(foot.point, best.point);
    }
  }
}

TEST(SignedDistance, BoxIsExact) {
  const Vec3 low(-1, -2, -0.5);
  const Vec3 high(1.5, 2, 0.75);
  const SurfaceDistance surface = built(test::box(low, high));
  for (const Vec3& x : randomPoints(5000, 4, 31, Vec3::Zero())) {
    EXPECT_NEAR(surface.signedDistance(x), boxPhi(x, low, high), 1e-14);
  }
}

TEST(SignedDistance, LShapeIsExactAtItsConcaveEdge) {
  const SurfaceDistance surface = built(test::lShape());
  for (const Vec3& x : randomPoints(5000, 1.5, 37, Vec3(1, 1, 0.5))) {
    EXPECT_NEAR(surface.signedDistance(x), lShapePhi(x), 1e-14) << x.transpose();
  }
}

TEST(SignedDistance, TorusHasTheWindingNumbersSign) {
  const SurfaceDistance surface = built(test::torus(2, 0.7, 48, 24));
  int inside = 0;
  for (const Vec3& x : randomPoints(5000, 3, 41, Vec3::Zero())) {
    const double phi = surface.signedDistance(x);
    EXPECT_EQ(phi<0, surface.windingNumber(x)> 0.5) << x.transpose();
    const double exact = std::hypot(std::hypot(x[0], x[1]) - 2, x[2]) - 0.7;
    EXPECT_NEAR(phi, exact, 0.02);  // sag of 48 and 24 chords: R (1 - cos(pi / n))
    inside += phi < 0 ? 1 : 0;
  }
  EXPECT_GT(inside, 200);
}

TEST(SignedDistance, PointsOnTheSurfaceAreAtZeroAndOutside) {
  const SurfaceDistance surface = built(test::box(Vec3(0, 0, 0), Vec3(1, 1, 1)));
  for (int i = 0; i <= 10; ++i) {
    for (int j = 0; j <= 10; ++j) {
      for (const Vec3& x :
           {Vec3(0.1 * i, 0.1 * j, 1), Vec3(0.1 * i, 0, 0.1 * j), Vec3(1, 0.1 * i, 0.1 * j)}) {
        const FootPoint foot = surface.foot(x);
        EXPECT_EQ(foot.distance, 0);
        EXPECT_EQ(foot.sign, 1);
        EXPECT_NEAR(surface.gradient(x, foot).norm(), 1, 1e-15);
      }
    }
  }
  const FootPoint corner = surface.foot(Vec3(1, 1, 1));
  EXPECT_EQ(corner.kind, FeatureKind::Vertex);
  EXPECT_LT((surface.gradient(Vec3(1, 1, 1), corner) - Vec3(1, 1, 1) / std::sqrt(3)).norm(), 1e-15);
}

TEST(Gradient, PointsTowardsLargerPhi) {
  const SurfaceDistance surface = built(test::lShape());
  const double step = 1e-6;
  int checked = 0;
  for (const Vec3& x : randomPoints(2000, 1.5, 43, Vec3(1, 1, 0.5))) {
    const FootPoint foot = surface.foot(x);
    const Vec3 g = surface.gradient(x, foot);
    EXPECT_NEAR(g.norm(), 1, 1e-14);
    const double ahead = surface.signedDistance(x + step * g);
    const double behind = surface.signedDistance(x - step * g);
    // Off the medial axis phi grows at rate 1; a step may cross the axis at a few points.
    if (std::abs(ahead - behind - 2 * step) < 1e-12) ++checked;
  }
  EXPECT_GT(checked, 1990);
}

TEST(FeatureOf, NamesFacesEdgesAndVertices) {
  const SurfaceDistance surface = built(test::box(Vec3(0, 0, 0), Vec3(1, 1, 1)));
  auto feature = [&](double x, double y, double z) {
    return surface.featureOf(surface.foot(Vec3(x, y, z)));
  };
  EXPECT_EQ(feature(0.3, 0.4, 2), (Feature{FeatureKind::Face, 5}));
  EXPECT_EQ(feature(0.5, 0.5, 2), (Feature{FeatureKind::Face, 5}));  // foot on the diagonal
  EXPECT_EQ(feature(0.3, -1, 2), (Feature{FeatureKind::Edge, 4}));
  EXPECT_EQ(feature(2, -1, 2), (Feature{FeatureKind::Vertex, 5}));
  EXPECT_EQ(surface.featureOf(FootPoint{}), Feature{});
}

TEST(FeatureOf, InnerPointsOfAnEdgeBelongToIt) {
  TriMesh mesh = test::sheet(2);
  mesh.edgeOf.assign(3 * mesh.triangles.size(), kNone);
  mesh.edgeOf[0] = 9;  // side 0-1 of the border; point 1 carries no vertex label
  const SurfaceDistance surface = built(mesh);
  EXPECT_EQ(surface.featureOf(surface.foot(Vec3(0.5, -1, 0))), (Feature{FeatureKind::Edge, 9}));
}

TEST(OpenSheet, HasASideAndABorder) {
  const SurfaceDistance surface = built(test::sheet(4));
  EXPECT_FALSE(surface.closed());
  EXPECT_EQ(surface.signedDistance(Vec3(0.4, 0.6, 0.5)), 0.5);
  EXPECT_EQ(surface.signedDistance(Vec3(0.4, 0.6, -0.5)), -0.5);
  EXPECT_TRUE(surface.foot(Vec3(-0.1, 0.6, 0.5)).beyondBorder);
  EXPECT_TRUE(surface.foot(Vec3(-0.1, -0.1, 0.5)).beyondBorder);
  EXPECT_TRUE(surface.foot(Vec3(0.25, -0.1, 0)).beyondBorder);
  // Straight above the border: still its own.
  for (const Vec3& x : {Vec3(0, 0.6, 0.5), Vec3(0, 0, -0.5), Vec3(1, 0.25, 2), Vec3(0, 0.6, 0)}) {
    EXPECT_FALSE(surface.foot(x).beyondBorder) << x.transpose();
  }
}

TEST(SignRuleUnion, IsInsideWhereAnyPartIs) {
  const std::vector<Box3> solids = {{Vec3(0, 0, 0), Vec3(1, 1, 1)},            // touches the next
                                    {Vec3(1, 0, 0), Vec3(2, 1, 1)},            //
                                    {Vec3(1.5, 0.5, 0.5), Vec3(2.5, 1.5, 2)},  // overlaps it
                                    {Vec3(0.4, 0.4, 0.4), Vec3(0.6, 0.6, 0.6)}};  // in the cavity
  const Box3 cavity(Vec3(0.25, 0.25, 0.25), Vec3(0.75, 0.75, 0.75));              // of the first
  TriMesh mesh;
  for (const Box3& solid : solids) test::append(mesh, test::box(solid.min(), solid.max()));
  test::append(mesh, test::box(cavity.min(), cavity.max()), true);
  auto surface = SurfaceDistance::build(mesh, SignRule::Union);
  ASSERT_TRUE(surface.has_value());
  int inside = 0;
  for (const Vec3& x : randomPoints(5000, 1.6, 53, Vec3(1.2, 0.8, 0.9))) {
    bool expected = false;
    for (std::size_t i = 0; i < solids.size(); ++i)
      expected = expected || (solids[i].contains(x) && !(i == 0 && cavity.contains(x)));
    EXPECT_EQ(surface->foot(x).sign < 0, expected) << x.transpose();
    inside += expected ? 1 : 0;
  }
  EXPECT_GT(inside, 300);
}

// A plate with a round hole is triangulated by slivers from rim to rim: the trees cut their boxes,
// the feet must stay the same to the last bit.
TEST(ClosestPoint, OfLongObliqueTrianglesIsThatOfALoop) {
  TriMesh mesh;
  constexpr Index kRim = 200;
  for (Index i = 0; i < kRim; ++i) {
    const double angle = 2 * std::numbers::pi * i / kRim;
    mesh.points.emplace_back(0.01 * std::cos(angle), 0.01 * std::sin(angle), 0);
    mesh.points.emplace_back(3 * std::cos(angle) + 1, 2 * std::sin(angle), 0.3 * std::sin(angle));
  }
  for (Index i = 0; i < kRim; ++i) {
    const Index j = (i + 1) % kRim;
    mesh.triangles.push_back({2 * i, 2 * i + 1, 2 * j + 1});
    mesh.triangles.push_back({2 * i, 2 * j + 1, 2 * j});
  }
  const SurfaceDistance surface = built(mesh);
  for (const Vec3& x : randomPoints(500, 3, 59, Vec3::Zero())) {
    const FootPoint foot = surface.foot(x);
    const FootPoint loop = bruteForce(surface, x);
    EXPECT_EQ(foot.distance, loop.distance);
    EXPECT_EQ(foot.triangle, loop.triangle);
    EXPECT_EQ(foot.point, loop.point);
  }
}

TEST(WindingNumber, IsOneInsideAndZeroOutside) {
  const SurfaceDistance surface = built(test::sphere(1, 5));
  for (const Vec3& x : randomPoints(1000, 2, 47, Vec3::Zero())) {
    const double expected = x.norm() < 1 ? 1 : 0;
    // What the far field leaves out: measured 0.016 at most, see winding_number.cpp.
    if (std::abs(x.norm() - 1) < 0.01) continue;
    EXPECT_NEAR(surface.windingNumber(x), expected, 0.02);
  }
  // Above the middle of a square at height h the solid angle is 4 asin(1 / (1 + 4 h^2)).
  const SurfaceDistance sheet = built(test::sheet(8));
  for (const double h : {0.1, 0.5, 1.0, 4.0}) {
    const double expected = 4 * std::asin(1 / (1 + 4 * h * h)) / (4 * std::numbers::pi);
    EXPECT_NEAR(sheet.windingNumber(Vec3(0.5, 0.5, -h)), expected, 0.01);
  }
}

// A T-junction closed by a zero-area triangle on a sharp edge, and a triangle folded back flat: the
// pseudonormals there mean nothing.
TEST(SignedDistance, SurvivesZeroAreaAndFoldedTriangles) {
  TriMesh mesh = test::box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  // Split the top edge 4-5 (y = 0, z = 1) on the side face only.
  const auto middle = static_cast<Index>(mesh.points.size());
  mesh.points.emplace_back(0.5, 0, 1);
  auto side =
      std::find(mesh.triangles.begin(), mesh.triangles.end(), std::array<Index, 3>{0, 5, 4});
  ASSERT_NE(side, mesh.triangles.end());
  *side = {0, 5, middle};
  mesh.triangles.push_back({0, middle, 4});
  mesh.triangles.push_back({5, 4, middle});
  mesh.faceOf.clear();
  mesh.edgeOf.clear();
  mesh.vertexOf.clear();
  ASSERT_TRUE(diagnose(mesh).closedManifold());
  ASSERT_EQ(diagnose(mesh).degenerateTriangles, 1);
  for (const double x : {0.2, 0.5, 0.7}) {
    const SurfaceDistance surface = built(mesh);
    for (const Vec3& gap : {Vec3(0, -0.3, 0.01), Vec3(0, -0.01, 0.3), Vec3(0, -0.3, 0.3)}) {
      EXPECT_NEAR(surface.signedDistance(Vec3(x, 0, 1) + gap), gap.norm(), 1e-15);
    }
  }
  // Lift the middle out of the edge: the side face rises over the top like a fin without thickness,
  // two coplanar triangles back to back.
  mesh.points[static_cast<std::size_t>(middle)] = Vec3(0.5, 0, 1.2);
  const SurfaceDistance folded = built(mesh);
  EXPECT_GT(folded.signedDistance(Vec3(0.4, -0.2, 1.05)), 0);
  EXPECT_GT(folded.signedDistance(Vec3(0.4, 0.2, 1.3)), 0);
  EXPECT_LT(folded.signedDistance(Vec3(0.4, 0.2, 0.7)), 0);
}

TEST(SignedDistance, SolidsThatTouchInAnEdgeHaveTheRightSign) {
  TriMesh mesh;
  test::append(mesh, test::box(Vec3(0, 0, 0), Vec3(1, 1, 1)));
  test::append(mesh, test::box(Vec3(1, 1, 0), Vec3(2, 2, 1)));
  mesh = weld(mesh);
  ASSERT_EQ(diagnose(mesh).nonManifoldEdges, 1);
  const SurfaceDistance surface = built(mesh);
  for (const Vec3& x : randomPoints(2000, 1.5, 53, Vec3(1, 1, 0.5))) {
    const double phi =
        std::min(boxPhi(x, Vec3(0, 0, 0), Vec3(1, 1, 1)), boxPhi(x, Vec3(1, 1, 0), Vec3(2, 2, 1)));
    EXPECT_NEAR(surface.signedDistance(x), phi, 1e-14);
  }
}

TEST(Build, RefusesWhatIsNoMesh) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(SurfaceDistance::build({}).error().code, ErrorCode::InvalidArgument);
  TriMesh mesh = test::box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  mesh.points[2][0] = inf;
  auto bad = SurfaceDistance::build(mesh);
  ASSERT_FALSE(bad.has_value());
  EXPECT_EQ(bad.error().where, "point 2");
  mesh = test::box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  mesh.triangles[5][1] = 8;
  bad = SurfaceDistance::build(mesh);
  ASSERT_FALSE(bad.has_value());
  EXPECT_EQ(bad.error().where, "triangle 5");
  mesh = test::box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  mesh.faceOf.pop_back();
  EXPECT_EQ(SurfaceDistance::build(mesh).error().code, ErrorCode::InvalidArgument);
}

TEST(Build, AcceptsTrianglesThatAreSegmentsOrPoints) {
  TriMesh mesh;
  mesh.points = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(5, 0, 0)};
  mesh.triangles = {{0, 1, 2}, {3, 3, 3}};
  const SurfaceDistance surface = built(mesh);
  EXPECT_EQ(surface.foot(Vec3(1.5, 2, 0)).distance, 2);
  EXPECT_EQ(surface.foot(Vec3(5, 0, 3)).distance, 3);
}

TEST(SignedDistance, MovesWithTheModel) {
  const SurfaceDistance here = built(test::lShape());
  const Eigen::AngleAxisd turn(0.7, Vec3(1, 2, 3).normalized());
  const Vec3 shift(10, -20, 30);
  TriMesh mesh = test::lShape();
  for (Vec3& p : mesh.points) p = turn * p + shift;
  const SurfaceDistance there = built(mesh);
  for (const Vec3& x : randomPoints(1000, 1.5, 59, Vec3(1, 1, 0.5))) {
    EXPECT_NEAR(there.signedDistance(turn * x + shift), here.signedDistance(x), 1e-13);
  }
}

}  // namespace
}  // namespace phront
