#include "phront/distance_field.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "meshes.h"

namespace phront {
namespace {

SurfaceDistance built(TriMesh mesh) {
  auto surface = SurfaceDistance::build(std::move(mesh));
  EXPECT_TRUE(surface.has_value()) << surface.error().message;
  return std::move(*surface);
}

DistanceField solved(const SurfaceDistance& surface, const FieldOptions& options) {
  auto field = solveDistanceField(surface, options);
  EXPECT_TRUE(field.has_value()) << field.error().message;
  return std::move(*field);
}

GridIndex nodeOf(const DistanceField::Tile& tile, int n) {
  return {tile.coordinates[0] * 8 + n % 8, tile.coordinates[1] * 8 + n / 8 % 8,
          tile.coordinates[2] * 8 + n / 64};
}

/// Nodes whose distance or triangle differs from the nearest of all triangles, looped over.
struct Comparison {
  std::int64_t nodes = 0;
  std::int64_t wrong = 0;
};
Comparison againstBruteForce(const SurfaceDistance& surface, const DistanceField& field) {
  Comparison result;
  const auto count = static_cast<Index>(surface.mesh().triangles.size());
  for (const auto& tile : field.tiles()) {
    for (int n = 0; n < DistanceField::kNodesPerTile; ++n) {
      const auto at = static_cast<std::size_t>(n);
      const Vec3 x = field.position(nodeOf(tile, n));
      double best = std::numeric_limits<double>::infinity();
      Index triangle = kNone;
      for (Index t = 0; t < count; ++t) {
        const double d = surface.footOnTriangle(x, t).distance;
        if (d < best) {
          best = d;
          triangle = t;
        }
      }
      // The root may round two different squares to one distance: then the ids may differ.
      const bool sameFoot = tile.triangle[at] == triangle ||
                            surface.footOnTriangle(x, tile.triangle[at]).distance == best;
      ++result.nodes;
      if (std::abs(tile.phi[at]) != best || !sameFoot) ++result.wrong;
    }
  }
  return result;
}

TEST(DistanceField, NoNodeIsWrongOnASphere) {
  const SurfaceDistance surface = built(test::sphere(1, 3));
  const DistanceField field = solved(surface, {.spacing = 0.04, .bandMin = -0.15, .bandMax = 0.15});
  const Comparison c = againstBruteForce(surface, field);
  EXPECT_GT(c.nodes, 100'000);
  EXPECT_EQ(c.wrong, 0);
  EXPECT_EQ(field.signRepairs(), 0);
  for (const auto& tile : field.tiles()) {
    for (int n = 0; n < DistanceField::kNodesPerTile; ++n) {
      const double exact = field.position(nodeOf(tile, n)).norm() - 1;
      // Inscribed: phi exceeds the sphere's by at most the largest sag of the 512 triangles,
      // computed from their planes as 0.01527.
      const double excess = tile.phi[static_cast<std::size_t>(n)] - exact;
      EXPECT_GE(excess, -1e-14);
      EXPECT_LE(excess, 0.0153);
    }
  }
}

TEST(DistanceField, NoNodeIsWrongOnAnLShape) {
  const SurfaceDistance surface = built(test::lShape());
  // The spacing puts nodes on all faces, edges and vertices, and on the medial axis.
  const DistanceField field =
      solved(surface, {.spacing = 0.03125, .bandMin = -0.6, .bandMax = 0.25});
  const Comparison c = againstBruteForce(surface, field);
  EXPECT_GT(c.nodes, 100'000);
  EXPECT_EQ(c.wrong, 0);
  EXPECT_EQ(field.signRepairs(), 0);
}

TEST(DistanceField, NodesOnTheSurfaceAreZeroAndNeighboursHaveTheirSides) {
  const SurfaceDistance surface = built(test::box(Vec3(0, 0, 0), Vec3(1, 1, 1)));
  const DistanceField field = solved(surface, {.spacing = 0.1, .bandMin = -0.3, .bandMax = 0.3});
  for (int i = 0; i <= 10; ++i) {
    for (int j = 0; j <= 10; ++j) {
      EXPECT_EQ(field.phi({i, j, 0}), 0);
      EXPECT_EQ(field.phi({0, i, j}), 0);
      EXPECT_NEAR(*field.phi({i, j, -1}), 0.1, 1e-15);
      if (i > 0 && i < 10 && j > 0 && j < 10) {
        EXPECT_NEAR(*field.phi({i, j, 1}), -0.1, 1e-15);
      }
    }
  }
}

TEST(DistanceField, HoldsTheBandAndLittleElse) {
  const SurfaceDistance surface = built(test::sphere(1, 3));
  const double h = 0.04;
  for (const auto& [low, high] : {std::pair{-0.05, 0.05}, {0.3, 0.4}, {-0.5, -0.4}, {0.2, 0.2}}) {
    const DistanceField field = solved(surface, {.spacing = h, .bandMin = low, .bandMax = high});
    ASSERT_FALSE(field.tiles().empty());
    for (int i = -1; i < 51; i += 3) {
      for (int j = -1; j < 51; j += 3) {
        for (int k = -15; k < 66; k += 3) {
          const double phi = surface.signedDistance(field.position({i, j, k}));
          const auto held = field.phi({i, j, k});
          if (phi >= low && phi <= high) {
            ASSERT_TRUE(held.has_value());
          }
          if (held) {
            EXPECT_EQ(*held, phi);
          }
          // A tile is kept for one node of it at most two half diagonals away.
          const double diagonal = std::sqrt(3.0) * 7 * h;
          if (held) {
            EXPECT_TRUE(phi > low - diagonal && phi < high + diagonal);
          }
        }
      }
    }
  }
  EXPECT_TRUE(solved(surface, {.spacing = h, .bandMin = -3, .bandMax = -2}).tiles().empty());
}

TEST(DistanceField, SameBitsForAnyNumberOfThreads) {
  const SurfaceDistance surface = built(test::torus(2, 0.6, 40, 20));
  FieldOptions options{.spacing = 0.06, .bandMin = -0.3, .bandMax = 0.2, .threads = 1};
  const DistanceField one = solved(surface, options);
  ASSERT_GT(one.tiles().size(), 100U);
  for (const int threads : {2, 4}) {
    options.threads = threads;
    const DistanceField other = solved(surface, options);
    ASSERT_EQ(other.tiles().size(), one.tiles().size());
    for (std::size_t t = 0; t < one.tiles().size(); ++t) {
      EXPECT_EQ(other.tiles()[t].coordinates, one.tiles()[t].coordinates);
      EXPECT_EQ(other.tiles()[t].triangle, one.tiles()[t].triangle);
      EXPECT_EQ(std::memcmp(other.tiles()[t].phi.data(), one.tiles()[t].phi.data(),
                            sizeof(one.tiles()[t].phi)),
                0);
    }
  }
}

TEST(DistanceField, TilesAreSortedAndFound) {
  const SurfaceDistance surface = built(test::sphere(1, 2));
  const DistanceField field = solved(surface, {.spacing = 0.1, .bandMin = -0.1, .bandMax = 0.1});
  for (std::size_t t = 0; t < field.tiles().size(); ++t) {
    EXPECT_EQ(field.findTile(field.tiles()[t].coordinates), static_cast<Index>(t));
    if (t > 0) {
      EXPECT_LT(field.tiles()[t - 1].coordinates, field.tiles()[t].coordinates);
    }
  }
  EXPECT_EQ(field.findTile({1000, 0, 0}), kNone);
  EXPECT_EQ(field.phi({8000, 0, 0}), std::nullopt);
}

TEST(DistanceField, InterpolationIsExactForPlanesAndAbsentOffTheBand) {
  const SurfaceDistance surface = built(test::box(Vec3(0, 0, 0), Vec3(4, 4, 4)));
  const DistanceField field = solved(surface, {.spacing = 0.1, .bandMin = -0.4, .bandMax = 0.4});
  for (const double z : {3.7, 3.95, 4.0, 4.21}) {
    ASSERT_TRUE(field.interpolate(Vec3(2.03, 1.98, z)).has_value());
    EXPECT_NEAR(*field.interpolate(Vec3(2.03, 1.98, z)), z - 4, 1e-13);
  }
  EXPECT_FALSE(field.interpolate(Vec3(2, 2, 40)).has_value());
  EXPECT_FALSE(field.interpolate(Vec3(2, 2, std::nan(""))).has_value());
}

TEST(DistanceField, OpenSheetHasNoPhiBeyondItsBorder) {
  const SurfaceDistance surface = built(test::sheet(4));
  const DistanceField field = solved(surface, {.spacing = 0.05, .bandMin = -0.2, .bandMax = 0.2});
  int inside = 0;
  for (const auto& tile : field.tiles()) {
    for (int n = 0; n < DistanceField::kNodesPerTile; ++n) {
      const Vec3 x = field.position(nodeOf(tile, n));
      // One spacing clear of the border, where rounding decides.
      if (x.head<2>().minCoeff() > 0.01 && x.head<2>().maxCoeff() < 0.99) {
        ASSERT_TRUE(field.phi(nodeOf(tile, n)).has_value());
        EXPECT_EQ(*field.phi(nodeOf(tile, n)), x[2]);
        ++inside;
      }
      if (x.head<2>().minCoeff() < -0.01) {
        EXPECT_FALSE(field.phi(nodeOf(tile, n)).has_value());
      }
    }
  }
  EXPECT_GT(inside, 1000);
}

// Two overlapping boxes as one mesh: the walls inside the union have no sign of their own.
TEST(DistanceField, RepairsSignsWhereTheSurfaceIntersectsItself) {
  TriMesh mesh;
  test::append(mesh, test::box(Vec3(0, 0, 0), Vec3(2, 2, 2)));
  test::append(mesh, test::box(Vec3(1, 1, 1), Vec3(3, 3, 3)));
  const SurfaceDistance surface = built(mesh);
  const DistanceField field = solved(surface, {.spacing = 0.1, .bandMin = -1, .bandMax = 0.5});
  EXPECT_GT(field.signRepairs(), 0);
  for (const auto& tile : field.tiles()) {
    for (int n = 0; n < DistanceField::kNodesPerTile; ++n) {
      const double phi = tile.phi[static_cast<std::size_t>(n)];
      if (std::abs(phi) < 1e-9) continue;
      const Vec3 x = field.position(nodeOf(tile, n));
      const bool material =
          (x.minCoeff() > 0 && x.maxCoeff() < 2) || (x.minCoeff() > 1 && x.maxCoeff() < 3);
      EXPECT_EQ(phi < 0, material) << x.transpose();
    }
  }
}

TEST(DistanceField, InwardOrientedSurfaceBoundsAVoid) {
  TriMesh mesh = test::sphere(1, 3);
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  const SurfaceDistance surface = built(mesh);
  const DistanceField field = solved(surface, {.spacing = 0.1, .bandMin = -0.2, .bandMax = 0.2});
  EXPECT_EQ(field.signRepairs(), 0);
  EXPECT_GT(*field.interpolate(Vec3(0.9, 0, 0)), 0);
  EXPECT_LT(*field.interpolate(Vec3(0, 1.1, 0)), 0);
}

TEST(SolveDistanceField, RefusesBadOptions) {
  const SurfaceDistance surface = built(test::sphere(1, 1));
  const double nan = std::nan("");
  for (const FieldOptions& options :
       {FieldOptions{.spacing = 0, .bandMin = 0, .bandMax = 1},
        FieldOptions{.spacing = -1, .bandMin = 0, .bandMax = 1},
        FieldOptions{.spacing = nan, .bandMin = 0, .bandMax = 1},
        FieldOptions{.spacing = 0.1, .bandMin = 1, .bandMax = 0},
        FieldOptions{.spacing = 0.1, .bandMin = nan, .bandMax = 0},
        FieldOptions{.spacing = 0.1, .bandMin = 0, .bandMax = 1, .threads = -1}}) {
    const auto field = solveDistanceField(surface, options);
    ASSERT_FALSE(field.has_value());
    EXPECT_EQ(field.error().code, ErrorCode::InvalidArgument);
  }
}

TEST(SolveDistanceField, RefusesWhatWouldNotFitInMemory) {
  const SurfaceDistance surface = built(test::sphere(1, 1));
  for (const double h : {1e-3, 1e-7, 1e-12}) {
    const auto field = solveDistanceField(
        surface, {.spacing = h, .bandMin = 0, .bandMax = 0.1, .maxNodes = 1'000'000});
    ASSERT_FALSE(field.has_value());
    EXPECT_EQ(field.error().code, ErrorCode::ResourceLimit);
  }
}

TEST(SolveDistanceField, StopsWhenAsked) {
  const SurfaceDistance surface = built(test::sphere(1, 3));
  int calls = 0;
  double last = -1;
  const Progress progress([&](double fraction, std::string_view) {
    EXPECT_GE(fraction, last);
    last = fraction;
    return ++calls < 8;
  });
  const auto field =
      solveDistanceField(surface, {.spacing = 0.02, .bandMin = -0.1, .bandMax = 0.1}, progress);
  ASSERT_FALSE(field.has_value());
  EXPECT_EQ(field.error().code, ErrorCode::Cancelled);
  EXPECT_EQ(calls, 8);
}

}  // namespace
}  // namespace phront
