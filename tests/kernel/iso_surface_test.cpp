#include "phront/iso_surface.h"

#include <gtest/gtest.h>

#include "random_meshes.h"

namespace phront {
namespace {

constexpr double kPi = std::numbers::pi;

SurfaceDistance distanceTo(const TriMesh& mesh) {
  auto surface = SurfaceDistance::build(mesh);
  EXPECT_TRUE(surface.has_value());
  return std::move(*surface);
}

IsoSurface isoOf(const SurfaceDistance& surface, double level, int threads = 1,
                 std::optional<double> spacing = {}) {
  auto result = isoSurface(surface, {.level = level, .spacing = spacing, .threads = threads});
  EXPECT_TRUE(result.has_value()) << result.error().message;
  return result ? std::move(*result) : IsoSurface{};
}

/// Closed, on the level, labelled.
void expectSound(const SurfaceDistance& surface, const IsoSurface& iso, double level) {
  const MeshDiagnostics d = diagnose(iso.mesh);
  EXPECT_TRUE(d.closedManifold()) << "free " << d.freeEdges << " edges " << d.nonManifoldEdges
                                  << " points " << d.nonManifoldPoints << " misoriented "
                                  << d.misorientedEdges;
  EXPECT_GT(signedVolume(iso.mesh), 0);
  const double promised = 1e-9 * surface.box().diagonal().norm();
  double worst = 0;
  for (const Vec3& p : iso.mesh.points) {
    worst = std::max(worst, std::abs(surface.signedDistance(p) - level));
  }
  EXPECT_LE(worst, promised);
  EXPECT_LE(iso.maxResidual, promised);
  ASSERT_EQ(iso.labelOfPoint.size(), iso.mesh.points.size());
  ASSERT_EQ(iso.mesh.faceOf.size(), iso.mesh.triangles.size());
  EXPECT_TRUE(std::is_sorted(iso.labels.begin(), iso.labels.end()));
  const auto valid = [&](Index l) { return l >= 0 && l < static_cast<Index>(iso.labels.size()); };
  EXPECT_TRUE(std::ranges::all_of(iso.labelOfPoint, valid));
  EXPECT_TRUE(std::ranges::all_of(iso.mesh.faceOf, valid));
}

const Eigen::Quaterniond kTurn = Eigen::Quaterniond(0.8, 0.3, -0.4, 0.33).normalized();

TEST(IsoSurface, BoxInwardIsTheSmallerBoxExactly) {
  const SurfaceDistance surface = distanceTo(test::box({0, 0, 0}, {1, 1, 1}));
  for (const double level : {-0.1, -0.3, -0.45}) {
    const IsoSurface iso = isoOf(surface, level);
    expectSound(surface, iso, level);
    // Faces, creases and corners all carry exact vertices: round-off only.
    EXPECT_NEAR(signedVolume(iso.mesh) / std::pow(1 + 2 * level, 3), 1, 1e-9) << level;
    EXPECT_EQ(iso.labels.size(), 6U);
  }
}

TEST(IsoSurface, TurnedBoxInwardKeepsItsCreases) {
  const SurfaceDistance surface =
      distanceTo(test::placed(test::box({0, 0, 0}, {1, 1, 1}), kTurn, 1, {0.3, -0.2, 5}));
  for (const double level : {-0.1, -0.3}) {
    const IsoSurface iso = isoOf(surface, level);
    expectSound(surface, iso, level);
    EXPECT_NEAR(signedVolume(iso.mesh) / std::pow(1 + 2 * level, 3), 1, 2e-5) << level;
  }
}

TEST(IsoSurface, ConvexSolidOutwardObeysSteiner) {
  const SurfaceDistance surface = distanceTo(test::box({0, 0, 0}, {1, 2, 3}));
  for (const double d : {0.1, 0.3, 1.0}) {
    const IsoSurface iso = isoOf(surface, d, 1, 0.06);
    expectSound(surface, iso, d);
    // V + A d + M d^2 + 4/3 pi d^3 with M = pi * (sum of the three edge lengths).
    const double steiner = 6 + 22 * d + 6 * kPi * d * d + 4.0 / 3 * kPi * d * d * d;
    // Chords cut h^2 / (8 d) off the rounded parts, 2e-3 of this volume at h = 0.06, d = 0.1.
    EXPECT_NEAR(signedVolume(iso.mesh) / steiner, 1, 2e-3) << d;
    EXPECT_LT(signedVolume(iso.mesh), steiner);
    EXPECT_EQ(iso.labels.size(), 26U);  // 6 faces, 12 edges, 8 vertices
  }
}

TEST(IsoSurface, EmptyExactlyBeyondTheInradius) {
  const SurfaceDistance surface = distanceTo(test::box({0, 0, 0}, {1, 1.2, 1.1}));
  const IsoSurface last = isoOf(surface, -0.499);
  expectSound(surface, last, -0.499);
  EXPECT_NEAR(signedVolume(last.mesh), 0.002 * 0.202 * 0.102, 1e-2 * 0.002 * 0.202 * 0.102);
  const IsoSurface none = isoOf(surface, -0.501);
  EXPECT_TRUE(none.mesh.triangles.empty());
  EXPECT_TRUE(none.mesh.points.empty());
  EXPECT_TRUE(none.labels.empty());
}

TEST(IsoSurface, FindsSheetsThinnerThanTheGrid) {
  const SurfaceDistance surface = distanceTo(test::box({0, 0, 0}, {0.4, 0.3, 0.1}));
  const IsoSurface iso = isoOf(surface, -0.0485, 1, 0.014);
  expectSound(surface, iso, -0.0485);
  EXPECT_TRUE(iso.refined);
  EXPECT_LT(iso.finestSpacing, 0.014);
  EXPECT_NEAR(signedVolume(iso.mesh) / (0.303 * 0.203 * 0.003), 1, 1e-2);
  EXPECT_EQ(diagnose(iso.mesh).components, 1);
}

/// A block with a slot from top to bottom that is wider at its mouth than at its end: grown by 0.1
/// only a gap that thins out from 0.02 to nothing is left of it.
TriMesh slottedBlock() {
  return test::prism({{0, 0}, {2, 0}, {2, 2}, {1.11, 2}, {1.1, 1}, {0.9, 1}, {0.89, 2}, {0, 2}},
                     {{0, 5, 6}, {0, 6, 7}, {0, 1, 4}, {0, 4, 5}, {1, 2, 3}, {1, 3, 4}}, 0, 1);
}

TEST(IsoSurface, FindsGapsThatThinOutAndRefinesThereOnly) {
  const SurfaceDistance surface = distanceTo(slottedBlock());
  IsoSurfaceOptions options;
  options.level = 0.1;
  options.spacing = 0.06;
  options.threads = 1;
  options.mostRefinedNodes = 0;
  const auto plain = isoSurface(surface, options);
  ASSERT_TRUE(plain.has_value()) << plain.error().message;
  EXPECT_TRUE(plain->unresolved);
  EXPECT_DOUBLE_EQ(plain->finestSpacing, plain->spacing);

  options.mostRefinedNodes = 2'000'000;
  const auto iso = isoSurface(surface, options);
  ASSERT_TRUE(iso.has_value()) << iso.error().message;
  expectSound(surface, *iso, 0.1);
  EXPECT_TRUE(iso->refined);
  EXPECT_FALSE(iso->unresolved);
  EXPECT_DOUBLE_EQ(iso->spacing, 0.06);
  EXPECT_LT(iso->finestSpacing, 0.06 / 8);
  // Both walls of the gap are there: far more than two spacings deep, where nothing was before.
  const auto inGap = [](const IsoSurface& front) {
    return std::ranges::count_if(front.mesh.points, [](const Vec3& p) {
      return std::abs(p[0] - 1) < 0.01 && p[1] > 1.5 && p[1] < 1.8 && p[2] > 0.2 && p[2] < 0.8;
    });
  };
  EXPECT_EQ(inGap(*plain), 0);
  EXPECT_GT(inGap(*iso), 100);
  // A grid of the finest cells everywhere would have thousands of times as many.
  EXPECT_LT(iso->mesh.triangles.size(), 40 * plain->mesh.triangles.size());
}

TEST(IsoSurface, ConcaveEdgeOutwardStaysSharp) {
  const SurfaceDistance surface = distanceTo(test::lShape());
  const double d = 0.2;
  const IsoSurface iso = isoOf(surface, d, 1, 0.05);
  expectSound(surface, iso, d);
  int onCrease = 0;
  for (const Vec3& p : iso.mesh.points) {
    if ((p - Vec3(1 + d, 1 + d, p[2])).norm() < 1e-9 && p[2] > 0 && p[2] < 1) ++onCrease;
  }
  EXPECT_GE(onCrease, static_cast<int>(0.9 / iso.spacing));  // one per cell along the edge
}

TEST(IsoSurface, SphereAndTorusMeetTheirVolumes) {
  const SurfaceDistance ball = distanceTo(test::sphere(1, 3));
  for (const double d : {-0.5, 0.4}) {
    const IsoSurface iso = isoOf(ball, d, 1, 0.08);
    expectSound(ball, iso, d);
    // The input itself is a polyhedron inside the sphere (volume 2 % short).
    EXPECT_NEAR(signedVolume(iso.mesh) / (4.0 / 3 * kPi * std::pow(1 + d, 3)), 1, 6e-2);
  }
  const SurfaceDistance ring = distanceTo(test::torus(1, 0.4, 60, 30));
  const IsoSurface open = isoOf(ring, 0.3, 1, 0.08);
  expectSound(ring, open, 0.3);
  EXPECT_NEAR(signedVolume(open.mesh) / (2 * kPi * kPi * 0.49), 1, 2e-2);
  const IsoSurface closed = isoOf(ring, 0.7, 1, 0.08);  // the hole is gone
  expectSound(ring, closed, 0.7);
  const auto euler = [](const TriMesh& m) {
    return static_cast<int>(m.points.size()) - static_cast<int>(m.triangles.size()) / 2;
  };
  EXPECT_EQ(euler(open.mesh), 0);
  EXPECT_EQ(euler(closed.mesh), 2);
}

TEST(IsoSurface, LevelZeroIsTheSurfaceItself) {
  const SurfaceDistance surface = distanceTo(test::box({0, 0, 0}, {1, 1, 1}));
  const IsoSurface iso = isoOf(surface, 0, 1, 0.03);
  expectSound(surface, iso, 0);
  EXPECT_NEAR(signedVolume(iso.mesh), 1, 1e-4);
}

TEST(IsoSurface, SameBitsAtAnyThreadCount) {
  std::mt19937_64 rng(7);
  const SurfaceDistance surface =
      distanceTo(test::placed(test::randomCells(rng, 3), kTurn, 1, Vec3::Zero()));
  const double level = 0.05 * surface.box().diagonal().norm();
  const double spacing = 0.5 * level;
  const IsoSurface one = isoOf(surface, level, 1, spacing);
  ASSERT_FALSE(one.mesh.triangles.empty());
  for (const int threads : {2, 4}) {
    const IsoSurface other = isoOf(surface, level, threads, spacing);
    EXPECT_EQ(one.mesh.points, other.mesh.points);
    EXPECT_EQ(one.mesh.triangles, other.mesh.triangles);
    EXPECT_EQ(one.mesh.faceOf, other.mesh.faceOf);
    EXPECT_EQ(one.labelOfPoint, other.labelOfPoint);
  }
}

TEST(IsoSurface, OpenSheetGivesASheetOnTheAskedSide) {
  const SurfaceDistance surface = distanceTo(test::sheet(4));
  const IsoSurface iso = isoOf(surface, 0.1);
  ASSERT_FALSE(iso.mesh.triangles.empty());
  for (const Vec3& p : iso.mesh.points) EXPECT_NEAR(p[2], 0.1, 1e-9);
  const MeshDiagnostics d = diagnose(iso.mesh);
  EXPECT_GT(d.freeEdges, 0);
  EXPECT_EQ(d.nonManifoldEdges + d.misorientedEdges + d.nonManifoldPoints, 0);
  EXPECT_NEAR(area(iso.mesh), 1, 0.1);
}

TEST(IsoSurface, RefusesBadOptionsAndStopsWhenAsked) {
  const SurfaceDistance surface = distanceTo(test::box({0, 0, 0}, {1, 1, 1}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto code = [&](const IsoSurfaceOptions& options) {
    const auto result = isoSurface(surface, options);
    return result ? std::optional<ErrorCode>() : result.error().code;
  };
  EXPECT_EQ(code({.level = nan}), ErrorCode::InvalidArgument);
  EXPECT_EQ(code({.level = 0.1, .spacing = 0.0}), ErrorCode::InvalidArgument);
  EXPECT_EQ(code({.level = 0.1, .spacing = nan}), ErrorCode::InvalidArgument);
  EXPECT_EQ(code({.level = 0.1, .threads = -1}), ErrorCode::InvalidArgument);
  EXPECT_EQ(code({.level = 0.1, .mostSquares = 0}), ErrorCode::InvalidArgument);
  EXPECT_EQ(code({.level = 0.1, .creaseTolerance = nan}), ErrorCode::InvalidArgument);
  EXPECT_EQ(code({.level = 0.1, .spacing = 1e-4}), ErrorCode::ResourceLimit);
  EXPECT_EQ(code({.level = 0.1, .spacing = 1e-9}), ErrorCode::ResourceLimit);
  const auto stopped =
      isoSurface(surface, {.level = 0.1}, Progress([](double, std::string_view) { return false; }));
  ASSERT_FALSE(stopped.has_value());
  EXPECT_EQ(stopped.error().code, ErrorCode::Cancelled);
}

TEST(IsoSurface, SpreadsNoMoreSquaresThanAllowed) {
  const SurfaceDistance surface = distanceTo(test::box({0, 0, 0}, {1, 1, 1}));  // area 6
  IsoSurfaceOptions options;
  options.level = 0.1;
  options.mostSquares = 600;
  options.mostRefinedNodes = 0;
  const auto iso = isoSurface(surface, options);
  ASSERT_TRUE(iso.has_value()) << iso.error().message;
  EXPECT_NEAR(iso->spacing, 0.1, 1e-12);
  expectSound(surface, *iso, 0.1);
  options.largestSpacing = 0.05;
  const auto fine = isoSurface(surface, options);
  ASSERT_TRUE(fine.has_value()) << fine.error().message;
  EXPECT_NEAR(fine->spacing, 0.05, 1e-12);
}

}  // namespace
}  // namespace phront
