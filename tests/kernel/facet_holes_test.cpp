// Holes are cut into a front that is known, and filled again.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "facets.h"
#include "meshes.h"
#include "phront/facet.h"

namespace phront {
namespace {

SurfaceDistance distanceTo(TriMesh mesh) { return *SurfaceDistance::build(std::move(mesh)); }

/// Part of the front that stays, and the loops around what went.
struct Cut {
  TriMesh around;
  std::vector<std::vector<Vec3>> loops;
  double area = 0;  ///< that went
};

Cut cut(const TriMesh& front, const std::function<bool(const Vec3&)>& goes) {
  Cut result;
  std::map<std::pair<Index, Index>, int> gone;
  result.around.points = front.points;
  for (const auto& t : front.triangles) {
    const auto at = [&](std::size_t k) { return front.points[static_cast<std::size_t>(t[k])]; };
    if (!goes((at(0) + at(1) + at(2)) / 3)) {
      result.around.triangles.push_back(t);
      continue;
    }
    result.area += 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
    for (std::size_t k = 0; k < 3; ++k) ++gone[{t[k], t[(k + 1) % 3]}];
  }
  std::map<Index, Index> next;  // what goes is on the left
  for (const auto& [side, count] : gone)
    if (!gone.contains({side.second, side.first})) next[side.first] = side.second;
  while (!next.empty()) {
    std::vector<Vec3>& loop = result.loops.emplace_back();
    for (Index p = next.begin()->first; next.contains(p);) {
      loop.push_back(front.points[static_cast<std::size_t>(p)]);
      const Index to = next.at(p);
      next.erase(p);
      p = to;
    }
  }
  return result;
}

/// The corners come first, the loops' sides are used once, along the loop, and all others twice.
void expectFills(const FacetedSurface& facets, const std::vector<std::vector<Vec3>>& loops) {
  std::set<std::pair<Index, Index>> border;
  Index first = 0;
  for (const auto& loop : loops) {
    const auto n = static_cast<Index>(loop.size());
    for (Index k = 0; k < n; ++k) {
      EXPECT_EQ(facets.points[first + k], loop[k]);
      border.insert({first + k, first + (k + 1) % n});
    }
    first += n;
  }
  std::map<std::pair<Index, Index>, int> uses;
  for (const FacetPolygon& polygon : facets.polygons)
    for (const auto& loop : polygon.loops)
      for (std::size_t k = 0; k < loop.size(); ++k) ++uses[{loop[k], loop[(k + 1) % loop.size()]}];
  for (const auto& side : border) EXPECT_EQ(uses[side], 1);
  for (const auto& [side, count] : uses) {
    EXPECT_EQ(count, 1);
    EXPECT_NE(uses.contains({side.second, side.first}), border.contains(side));
  }
}

struct Filled {
  Cut cut;
  FacetedSurface facets;
};

Filled fill(const TriMesh& part, double level, double spacing, double tolerance,
            const std::function<bool(const Vec3&)>& goes) {
  const SurfaceDistance surface = distanceTo(part);
  IsoSurfaceOptions options;
  options.level = level;
  options.spacing = spacing;
  const auto front = isoSurface(surface, options);
  EXPECT_TRUE(front) << front.error().message;
  Filled filled;
  filled.cut = cut(front->mesh, goes);
  const SurfaceDistance around = distanceTo(filled.cut.around);
  const auto facets = facetHoles(surface, *front, level, {{filled.cut.loops}, around, spacing / 2},
                                 {.tolerance = tolerance, .planeOfFace = {}});
  EXPECT_TRUE(facets) << facets.error().message;
  if (facets) filled.facets = *facets;
  return filled;
}

TEST(FacetHoles, ACapOfARounding) {
  // The corner at (1, 1, 1) of a box: a sphere and parts of three cylinders and planes.
  const Filled filled = fill(test::box(Vec3(0, 0, 0), Vec3(1, 1, 1)), 0.3, 0.1, 0.003,
                             [](const Vec3& x) { return (x - Vec3(1, 1, 1)).norm() < 0.45; });
  ASSERT_EQ(filled.cut.loops.size(), 1U);
  expectFills(filled.facets, filled.cut.loops);
  EXPECT_NEAR(test::areaOf(filled.facets), filled.cut.area, 0.01 * filled.cut.area);
  EXPECT_LT(filled.facets.maxDeviation, 0.006);
}

TEST(FacetHoles, ASharpCornerComesBack) {
  // Inwards the front of a box is a box.
  const Filled filled = fill(test::box(Vec3(0, 0, 0), Vec3(1, 1, 1)), -0.1, 0.06, 0.001,
                             [](const Vec3& x) { return (x - Vec3(0.9, 0.9, 0.9)).norm() < 0.3; });
  ASSERT_EQ(filled.cut.loops.size(), 1U);
  expectFills(filled.facets, filled.cut.loops);
  EXPECT_NEAR(test::areaOf(filled.facets), filled.cut.area, 1e-3 * filled.cut.area);
  EXPECT_LT(filled.facets.maxDeviation, 0.001);
  const auto& points = filled.facets.points;
  EXPECT_TRUE(std::any_of(points.begin(), points.end(),
                          [](const Vec3& p) { return (p - Vec3(0.9, 0.9, 0.9)).norm() < 1e-3; }));
}

TEST(FacetHoles, ANarrowHoleIsFilledWithoutTheFront) {
  const Filled filled =
      fill(test::box(Vec3(0, 0, 0), Vec3(1, 1, 1)), 0.3, 0.1, 0.003, [](const Vec3& x) {
        return x[2] > 1.2 && std::abs(x[0] - 0.5) < 0.06 && std::abs(x[1] - 0.5) < 0.3;
      });
  ASSERT_EQ(filled.cut.loops.size(), 1U);
  expectFills(filled.facets, filled.cut.loops);
  EXPECT_NEAR(test::areaOf(filled.facets), filled.cut.area, 1e-9);
}

TEST(FacetHoles, ABeltHasTwoLoops) {
  const Filled filled =
      fill(test::sphere(1, 4), 0.2, 0.1, 0.003, [](const Vec3& x) { return std::abs(x[2]) < 0.5; });
  ASSERT_EQ(filled.cut.loops.size(), 2U);
  expectFills(filled.facets, filled.cut.loops);
  EXPECT_NEAR(test::areaOf(filled.facets), filled.cut.area, 0.01 * filled.cut.area);
}

TEST(FacetHoles, ComponentsThatAreMissingComeWithThem) {
  TriMesh both = test::sphere(1, 3);
  test::append(both, test::sphere(0.4, 3, Vec3(3, 0, 0)));
  both.faceOf.clear();
  both.edgeOf.clear();
  both.vertexOf.clear();
  const Filled filled =
      fill(both, 0.2, 0.1, 0.003, [](const Vec3& x) { return x[0] > 2 || x[2] > 0.8; });
  ASSERT_EQ(filled.cut.loops.size(), 1U);
  expectFills(filled.facets, filled.cut.loops);
  EXPECT_NEAR(test::areaOf(filled.facets), filled.cut.area, 0.01 * filled.cut.area);
}

TEST(FacetHoles, BadHolesAreRefused) {
  const SurfaceDistance surface = distanceTo(test::box(Vec3(0, 0, 0), Vec3(1, 1, 1)));
  const auto front = isoSurface(surface, {.level = 0.3, .spacing = 0.2});
  ASSERT_TRUE(front);
  const SurfaceDistance around = distanceTo(front->mesh);
  const auto code = [&](const std::vector<std::vector<Vec3>>& loops) {
    const auto facets = facetHoles(surface, *front, 0.3, {{loops}, around, 0.1},
                                   {.tolerance = 0.01, .planeOfFace = {}});
    EXPECT_FALSE(facets);
    return facets ? ErrorCode::Failed : facets.error().code;
  };
  EXPECT_EQ(code({}), ErrorCode::InvalidArgument);
  EXPECT_EQ(code({{{0, 0, 0}, {1, 0, 0}}}), ErrorCode::InvalidArgument);
  EXPECT_EQ(code({{{0, 0, 1}, {1, 0, 1}, {NAN, 1, 1}}}), ErrorCode::InvalidArgument);
  std::vector<Vec3> ring;
  for (int i = 0; i < 1500; ++i)
    ring.emplace_back(std::cos(i * 2 * M_PI / 1500), std::sin(i * 2 * M_PI / 1500), 1.3);
  EXPECT_EQ(code({ring}), ErrorCode::ResourceLimit);
}

}  // namespace
}  // namespace phront
