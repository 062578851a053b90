#include <gtest/gtest.h>

#include <optional>

#include "phront/iso_surface.h"
#include "random_meshes.h"

namespace phront {
namespace {

/// Solid number `seed`: union of boxes, prism or box; turned, at scale 1e-3, 1 or 1e3.
TriMesh solid(std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  TriMesh mesh;
  if (seed % 3 == 0) mesh = test::randomCells(rng, 3);
  if (seed % 3 == 1) {
    mesh = test::regularPrism(static_cast<Index>(3 + seed % 29), test::uniform(rng, 0.2, 1),
                              test::uniform(rng, 0.1, 2));
  }
  if (seed % 3 == 2) {
    mesh = test::box({0, 0, 0}, {test::uniform(rng, 0.2, 1), test::uniform(rng, 0.2, 1),
                                 test::uniform(rng, 0.2, 1)});
  }
  const double scale = std::pow(10.0, 3.0 * (static_cast<double>(seed / 3 % 3) - 1));
  // Every fourth stays along the grid's axes: the degenerate positions.
  const Eigen::Quaterniond turn =
      seed % 4 == 0 ? Eigen::Quaterniond::Identity() : test::randomTurn(rng);
  const Vec3 shift(test::uniform(rng, -2, 2), test::uniform(rng, -2, 2), test::uniform(rng, -2, 2));
  return test::placed(std::move(mesh), turn, scale, scale * shift);
}

/// Random points further than `margin` from the level lie on the side of `mesh` that phi says.
void expectSides(const SurfaceDistance& surface, const TriMesh& mesh, double level, double margin) {
  std::optional<SurfaceDistance> result;
  if (!mesh.triangles.empty()) {
    auto built = SurfaceDistance::build(mesh);
    ASSERT_TRUE(built.has_value());
    result = std::move(*built);
  }
  std::mt19937_64 rng(1);
  const Vec3 low = surface.box().min() - Vec3::Constant(std::max(level, 0.0));
  const Vec3 size = surface.box().max() + Vec3::Constant(std::max(level, 0.0)) - low;
  int tested = 0;
  for (int i = 0; i < 1500; ++i) {
    const Vec3 u(test::uniform(rng, 0, 1), test::uniform(rng, 0, 1), test::uniform(rng, 0, 1));
    const Vec3 x = low + size.cwiseProduct(u);
    const double height = surface.signedDistance(x) - level;
    if (std::abs(height) < margin) continue;
    ++tested;
    const bool inside = result && result->windingNumber(x) > 0.5;
    EXPECT_EQ(inside, height < 0) << "height " << height / margin << " margins";
  }
  EXPECT_GT(tested, 100);
}

class IsoSurfaceProperty : public testing::TestWithParam<std::uint64_t> {};

TEST_P(IsoSurfaceProperty, ClosedOnTheLevelAndNested) {
  const TriMesh mesh = solid(GetParam());
  const auto surface = SurfaceDistance::build(mesh);
  ASSERT_TRUE(surface.has_value());
  const double diagonal = surface->box().diagonal().norm();
  const double smallest = surface->box().sizes().minCoeff();
  // Coarse on purpose: closedness may not depend on resolution.
  const double h = diagonal / 24;
  double volume = 0;
  int extracted = 0;
  for (const double part : {-0.4, -0.2, -0.05, 0.05, 0.4}) {
    const double level = part * smallest;
    const auto iso = isoSurface(*surface, {.level = level, .spacing = h, .threads = 1});
    ASSERT_TRUE(iso.has_value()) << iso.error().message;
    // Tips that poke into a cell without reaching a node may be cut: 0.29 h seen.
    expectSides(*surface, iso->mesh, level, 0.35 * iso->spacing);
    if (iso->mesh.triangles.empty()) {
      EXPECT_LT(level, 0);
      EXPECT_EQ(extracted, 0) << "empty beyond a level that was not";
      continue;
    }
    ++extracted;
    const MeshDiagnostics d = diagnose(iso->mesh);
    EXPECT_TRUE(d.closedManifold())
        << "level " << part << " edges " << d.nonManifoldEdges << " points " << d.nonManifoldPoints;
    EXPECT_LE(iso->maxResidual, 1e-9 * diagonal) << "level " << part;
    const double here = signedVolume(iso->mesh);
    // A coarse grid may lose a sliver at its creases, less than levels 10 % apart differ by.
    EXPECT_GT(here, volume) << "level " << part;
    volume = here;
  }
  EXPECT_GE(extracted, 3);
}

/// Cells of several sizes beside one another: as closed, and nearer to the level at its creases.
TEST_P(IsoSurfaceProperty, ClosedWhereCellsAreHalved) {
  const TriMesh mesh = solid(GetParam());
  const auto surface = SurfaceDistance::build(mesh);
  ASSERT_TRUE(surface.has_value());
  const double diagonal = surface->box().diagonal().norm();
  const double smallest = surface->box().sizes().minCoeff();
  const double h = diagonal / 20;
  int refined = 0;
  for (const double part : {-0.2, 0.4}) {
    const double level = part * smallest;
    IsoSurfaceOptions options;
    options.level = level;
    options.spacing = h;
    options.threads = 1;
    options.creaseTolerance = 0.02 * h;
    const auto iso = isoSurface(*surface, options);
    ASSERT_TRUE(iso.has_value()) << iso.error().message;
    if (iso->mesh.triangles.empty()) continue;
    refined += iso->refined ? 1 : 0;
    const MeshDiagnostics d = diagnose(iso->mesh);
    EXPECT_TRUE(d.closedManifold())
        << "level " << part << " free " << d.freeEdges << " edges " << d.nonManifoldEdges
        << " points " << d.nonManifoldPoints << " misoriented " << d.misorientedEdges;
    EXPECT_LE(iso->maxResidual, 1e-9 * diagonal) << "level " << part;
    options.threads = 3;
    const auto again = isoSurface(*surface, options);
    ASSERT_TRUE(again.has_value());
    EXPECT_EQ(iso->mesh.points, again->mesh.points);
    EXPECT_EQ(iso->mesh.triangles, again->mesh.triangles);
  }
  EXPECT_GE(refined, 1);
}

INSTANTIATE_TEST_SUITE_P(Solids, IsoSurfaceProperty, testing::Range<std::uint64_t>(0, 24));

}  // namespace
}  // namespace phront
