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

/// Nodes whose distance or triangle differs from the nearest of all triangles, looped over.
struct Comparison {
  std::int64_t nodes = 0;
  std::int64_t wrong = 0;
};
Comparison againstBruteForce(const SurfaceDistance& surface, const DistanceField& field) {
  Comparison result;
  const auto count = static_cast<Index>(surface.mesh().triangles.size());
  field.forNodes([&](const GridIndex& node, double phi, Index held) {
    const Vec3 x = field.position(node);
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
    const bool sameFoot = held == triangle || surface.footOnTriangle(x, held).distance == best;
    ++result.nodes;
    if (std::abs(phi) != best || !sameFoot) ++result.wrong;
  });
  return result;
}

TEST(DistanceField, NoNodeIsWrongOnASphere) {
  const SurfaceDistance surface = built(test::sphere(1, 3));
  const DistanceField field = solved(surface, {.spacing = 0.04, .bandMin = -0.15, .bandMax = 0.15});
  const Comparison c = againstBruteForce(surface, field);
  EXPECT_GT(c.nodes, 50'000);
  EXPECT_EQ(c.wrong, 0);
  EXPECT_EQ(field.signRepairs(), 0);
  field.forNodes([&](const GridIndex& node, double phi, Index) {
    // Inscribed: phi exceeds the sphere's by at most the largest sag of the 512 triangles,
    // computed from their planes as 0.01527.
    const double excess = phi - (field.position(node).norm() - 1);
    EXPECT_GE(excess, -1e-14);
    EXPECT_LE(excess, 0.0153);
  });
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

TEST(DistanceField, HoldsTheBandAndNothingElse) {
  const SurfaceDistance surface = built(test::sphere(1, 3));
  const double h = 0.04;
  for (const auto& [low, high] : {std::pair{-0.05, 0.05}, {0.3, 0.4}, {-0.5, -0.4}, {0.2, 0.202}}) {
    const DistanceField field = solved(surface, {.spacing = h, .bandMin = low, .bandMax = high});
    ASSERT_FALSE(field.tiles().empty());
    for (int i = -1; i < 51; i += 3) {
      for (int j = -1; j < 51; j += 3) {
        for (int k = -15; k < 66; k += 3) {
          const double phi = surface.signedDistance(field.position({i, j, k}));
          const auto held = field.phi({i, j, k});
          ASSERT_EQ(held.has_value(), phi >= low && phi <= high);
          if (held) {
            EXPECT_EQ(*held, phi);
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
      EXPECT_EQ(other.tiles()[t].held, one.tiles()[t].held);
      EXPECT_EQ(other.tiles()[t].first, one.tiles()[t].first);
    }
    EXPECT_EQ(other.triangles(), one.triangles());
    ASSERT_EQ(other.values().size(), one.values().size());
    EXPECT_EQ(std::memcmp(other.values().data(), one.values().data(),
                          one.values().size() * sizeof(double)),
              0);
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
  field.forNodes([&](const GridIndex& node, double, Index) {
    const Vec3 x = field.position(node);
    // One spacing clear of the border, where rounding decides.
    if (x.head<2>().minCoeff() > 0.01 && x.head<2>().maxCoeff() < 0.99) {
      ASSERT_TRUE(field.phi(node).has_value());
      EXPECT_EQ(*field.phi(node), x[2]);
      ++inside;
    }
    if (x.head<2>().minCoeff() < -0.01) {
      EXPECT_FALSE(field.phi(node).has_value());
    }
  });
  EXPECT_GT(inside, 1000);
}

// Both outward: the inner box lies in the material of the outer one. In a narrow band no neighbours
// contradict each other; the winding number of each region tells.
TEST(DistanceField, RepairsSignsOfAWholeRegion) {
  TriMesh mesh;
  test::append(mesh, test::box(Vec3(0, 0, 0), Vec3(4, 4, 4)));
  test::append(mesh, test::box(Vec3(1, 1, 1), Vec3(3, 3, 3)));
  const SurfaceDistance surface = built(mesh);
  const DistanceField field = solved(surface, {.spacing = 0.1, .bandMin = -0.35, .bandMax = 0.35});
  EXPECT_GT(field.signRepairs(), 1000);
  int within = 0;
  field.forNodes([&](const GridIndex& node, double phi, Index) {
    const Vec3 x = field.position(node);
    if (std::abs(phi) < 1e-9) return;
    EXPECT_EQ(phi < 0, x.minCoeff() > 0 && x.maxCoeff() < 4) << x.transpose();
    within += phi < 0 ? 1 : 0;
  });
  EXPECT_GT(within, 10'000);
}

// Two overlapping boxes as one mesh: the walls inside the union have no sign of their own.
TEST(DistanceField, RepairsSignsWhereTheSurfaceIntersectsItself) {
  TriMesh mesh;
  test::append(mesh, test::box(Vec3(0, 0, 0), Vec3(2, 2, 2)));
  test::append(mesh, test::box(Vec3(1, 1, 1), Vec3(3, 3, 3)));
  const SurfaceDistance surface = built(mesh);
  const DistanceField field = solved(surface, {.spacing = 0.1, .bandMin = -1, .bandMax = 0.5});
  EXPECT_GT(field.signRepairs(), 0);
  field.forNodes([&](const GridIndex& node, double phi, Index) {
    if (std::abs(phi) < 1e-9) return;
    const Vec3 x = field.position(node);
    const bool material =
        (x.minCoeff() > 0 && x.maxCoeff() < 2) || (x.minCoeff() > 1 && x.maxCoeff() < 3);
    EXPECT_EQ(phi < 0, material) << x.transpose();
  });
}

// First order on sparse tiles, both sides and far from the surface on one, against exact values.
TEST(DistanceField, SweptBandsAreNearTheExactOnes) {
  const double h = 0.04;
  for (const TriMesh& mesh : {test::sphere(1, 4), test::lShape()}) {
    const SurfaceDistance surface = built(mesh);
    for (const auto& [low, high] : {std::pair{-0.3, 0.3}, {0.35, 0.5}, {-0.4, -0.2}}) {
      FieldOptions options{.spacing = h, .bandMin = low, .bandMax = high};
      options.solver = FieldSolver::Godunov;
      const DistanceField swept = solved(surface, options);
      EXPECT_EQ(swept.signRepairs(), 0);
      int nodes = 0;
      int exact = 0;
      swept.forNodes([&](const GridIndex& node, double phi, Index triangle) {
        const Vec3 x = swept.position(node);
        const double truth = surface.signedDistance(x);
        ++nodes;
        EXPECT_TRUE(phi >= low && phi <= high);
        EXPECT_NEAR(phi, truth, 2 * h);
        EXPECT_EQ(phi < 0, truth < 0);
        EXPECT_LT(surface.footOnTriangle(x, triangle).distance, std::abs(truth) + 6 * h);
        if (std::abs(truth) <= std::sqrt(3.0) * h) {
          EXPECT_NEAR(phi, truth, 1e-15);
          ++exact;
        }
      });
      EXPECT_GT(nodes, 10'000);
      EXPECT_EQ(exact > 0, low < 0 && high > 0);
      options.threads = 4;
      const DistanceField again = solved(surface, options);
      EXPECT_EQ(again.values(), swept.values());
      EXPECT_EQ(again.triangles(), swept.triangles());
    }
  }
}

TEST(DistanceField, BandsOffAnOpenSheetLieOnBothSides) {
  const SurfaceDistance surface = built(test::sheet(4));
  const DistanceField field = solved(surface, {.spacing = 0.05, .bandMin = 0.12, .bandMax = 0.2});
  int above = 0;
  int below = 0;
  field.forNodes([&](const GridIndex& node, double phi, Index) {
    EXPECT_TRUE(std::abs(phi) >= 0.12 && std::abs(phi) <= 0.2);
    ++(field.position(node)[2] > 0 ? above : below);
  });
  EXPECT_GT(above, 500);
  EXPECT_GT(below, 500);
}

TEST(DistanceField, SweepingNeedsAClosedSurface) {
  const SurfaceDistance surface = built(test::sheet(3));
  FieldOptions options{.spacing = 0.1, .bandMin = -0.2, .bandMax = 0.2};
  options.solver = FieldSolver::Godunov;
  const auto field = solveDistanceField(surface, options);
  ASSERT_FALSE(field);
  EXPECT_EQ(field.error().where, "solver");
}

// Slots of a tile count its held nodes only.
TEST(DistanceField, TakesTwelveBytesANode) {
  const SurfaceDistance surface = built(test::sphere(1, 4));
  const double h = 0.02;
  const DistanceField field = solved(surface, {.spacing = h, .bandMin = -3 * h, .bandMax = 3 * h});
  const auto nodes = static_cast<double>(field.values().size());
  EXPECT_GT(nodes, 150'000);
  EXPECT_LT(static_cast<double>(field.memory()) / nodes, 13);
}

// What a block finds is what one query after the other finds, to the bit: slivers, segments and
// points among the triangles, a triangle a thousand spacings long, blocks far away.
TEST(SurfaceDistance, BlocksOfNodesAreQueriesToTheBit) {
  TriMesh odd = test::box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  odd = TriMesh{odd.points, odd.triangles, {}, {}, {}};  // no labels
  const auto base = static_cast<Index>(odd.points.size());
  for (const Vec3& p : {Vec3(0.3, 0.3, 1.5), Vec3(0.7, 0.3, 1.5), Vec3(0.5, 0.3 + 1e-9, 1.5),
                        Vec3(0.4, 0.6, 1.7), Vec3(40, -30, 1.2), Vec3(-50, 20, 1.3)})
    odd.points.push_back(p);
  odd.triangles.push_back({base, base + 1, base + 2});
  odd.triangles.push_back({base, base + 1, base + 1});
  odd.triangles.push_back({base + 3, base + 3, base + 3});
  odd.triangles.push_back({base + 3, base + 4, base + 5});
  for (const TriMesh& mesh : {odd, test::torus(2, 0.6, 40, 20), test::sheet(4)}) {
    const SurfaceDistance surface = built(mesh);
    int held = 0;
    for (const double h : {0.04, 0.3}) {
      for (const double reach : {3 * h, std::numeric_limits<double>::infinity()}) {
        for (const Vec3& first : {Vec3(-0.1, -0.1, 0.9), Vec3(0.2, 0.13, 1.35), Vec3(0, 0, 0),
                                  Vec3(1.8, -1, 0.1), Vec3(30, -30, 1), Vec3(200, 100, -300)}) {
          const BlockPhi block = surface.phiOnBlock(first, h, {-2, 3, 0}, reach);
          for (std::size_t n = 0; n < 512; ++n) {
            const Vec3 x = first + h * Vec3((n & 7) - 2.0, (n >> 3 & 7) + 3.0, n >> 6);
            const FootPoint foot = surface.foot(x);
            const bool isHeld = (block.held[n >> 6] >> (n & 63) & 1U) != 0;
            ASSERT_EQ(isHeld, foot.distance <= reach)
                << "h " << h << " reach " << reach << " node " << n << " of " << first.transpose()
                << ": " << foot.distance << " to " << foot.triangle;
            if (!isHeld) continue;
            ++held;
            EXPECT_EQ(block.phi[n], foot.phi());
            EXPECT_EQ(block.triangle[n], foot.beyondBorder ? kNone : foot.triangle);
          }
        }
      }
    }
    EXPECT_GT(held, 5000);
  }
}

TEST(DistanceField, InwardOrientedSurfaceBoundsAVoid) {
  TriMesh mesh = test::sphere(1, 3);
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  const SurfaceDistance surface = built(mesh);
  const DistanceField field = solved(surface, {.spacing = 0.1, .bandMin = -0.3, .bandMax = 0.3});
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
