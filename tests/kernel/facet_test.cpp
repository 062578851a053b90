#include "phront/facet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <set>

#include "meshes.h"

namespace phront {
namespace {

constexpr double kPi = std::numbers::pi;

TriMesh subdivided(TriMesh mesh, int levels) {
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<Index, Index>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [at, isNew] =
          middles.try_emplace(std::minmax({a, b}), static_cast<Index>(mesh.points.size()));
      if (isNew) mesh.points.push_back(0.5 * (mesh.points[a] + mesh.points[b]));
      return at->second;
    };
    std::vector<std::array<Index, 3>> finer;
    for (const auto& t : mesh.triangles) {
      const Index ab = middle(t[0], t[1]);
      const Index bc = middle(t[1], t[2]);
      const Index ca = middle(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], ab, ca}, {t[1], bc, ab}, {t[2], ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  mesh.faceOf.clear();
  mesh.edgeOf.clear();
  mesh.vertexOf.clear();
  return mesh;
}

/// phi = d from a mesh near it: points projected along the gradient, triangles labelled by the
/// feature under their centroid.
IsoSurface projected(const SurfaceDistance& surface, TriMesh near, double level) {
  IsoSurface iso;
  for (Vec3& p : near.points) {
    for (int step = 0; step < 5; ++step) {
      const FootPoint foot = surface.foot(p);
      p += (level - foot.phi()) * surface.gradient(p, foot);
    }
  }
  std::vector<Feature> found;
  for (const auto& t : near.triangles) {
    const Vec3 c = (near.points[t[0]] + near.points[t[1]] + near.points[t[2]]) / 3;
    found.push_back(surface.featureOf(surface.foot(c)));
  }
  const std::set<Feature> all(found.begin(), found.end());
  iso.labels.assign(all.begin(), all.end());
  for (const Feature& f : found) {
    near.faceOf.push_back(static_cast<Index>(
        std::lower_bound(iso.labels.begin(), iso.labels.end(), f) - iso.labels.begin()));
  }
  iso.mesh = std::move(near);
  return iso;
}

/// Planes of the faces of a mesh with planar faces.
std::vector<std::optional<Plane>> planesOf(const TriMesh& mesh) {
  std::vector<std::optional<Plane>> planes;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& c = mesh.triangles[t];
    const auto face = static_cast<std::size_t>(mesh.faceOf[t]);
    if (planes.size() <= face) planes.resize(face + 1);
    const Vec3 a = mesh.points[c[0]];
    const Vec3 n = (mesh.points[c[1]] - a).cross(mesh.points[c[2]] - a).normalized();
    planes[face] = Plane{n, n.dot(a)};
  }
  return planes;
}

SurfaceDistance distanceTo(const TriMesh& mesh) { return *SurfaceDistance::build(mesh); }

/// Volume of closed planar polygons: fans over each loop.
double volumeOf(const FacetedSurface& facets) {
  double sixfold = 0;
  for (const FacetPolygon& polygon : facets.polygons) {
    for (const auto& loop : polygon.loops) {
      for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
        sixfold +=
            facets.points[loop[0]].dot(facets.points[loop[k]].cross(facets.points[loop[k + 1]]));
      }
    }
  }
  return sixfold / 6;
}

/// Every directed side once in each direction, no loop with a point twice.
void expectClosed(const FacetedSurface& facets) {
  ASSERT_FALSE(facets.polygons.empty());
  std::set<std::pair<Index, Index>> sides;
  for (const FacetPolygon& polygon : facets.polygons) {
    for (const auto& loop : polygon.loops) {
      ASSERT_GE(loop.size(), 3u);
      EXPECT_EQ(std::set<Index>(loop.begin(), loop.end()).size(), loop.size());
      for (std::size_t k = 0; k < loop.size(); ++k) {
        EXPECT_TRUE(sides.insert({loop[k], loop[(k + 1) % loop.size()]}).second);
      }
    }
  }
  for (const auto& [a, b] : sides) EXPECT_TRUE(sides.contains({b, a}));
}

TEST(Facet, ShrunkBoxIsSixSquares) {
  const TriMesh box = test::box(Vec3(0, 0, 0), Vec3(4, 3, 2));
  const SurfaceDistance surface = distanceTo(box);
  const TriMesh inner = subdivided(test::box(Vec3(.5, .5, .5), Vec3(3.5, 2.5, 1.5)), 4);
  const IsoSurface iso = projected(surface, inner, -0.5);
  const auto facets =
      facetIsoSurface(surface, iso, -0.5, {.tolerance = 0.0015, .planeOfFace = planesOf(box)});
  ASSERT_TRUE(facets) << facets.error().message;
  expectClosed(*facets);
  EXPECT_EQ(facets->polygons.size(), 6u);
  EXPECT_EQ(facets->points.size(), 8u);
  EXPECT_NEAR(volumeOf(*facets), 6.0, 1e-12);  // exact planes, round-off only
  EXPECT_LE(facets->maxDeviation, 1e-12);
  EXPECT_LE(facets->maxNonPlanarity, 1e-12);
}

TEST(Facet, ShrunkLShapeKeepsItsConcaveCorner) {
  const TriMesh shape = test::lShape();
  const SurfaceDistance surface = distanceTo(shape);
  const double d = -0.2;
  const auto iso = isoSurface(surface, {.level = d, .spacing = {}});
  ASSERT_TRUE(iso) << iso.error().message;
  const auto facets =
      facetIsoSurface(surface, *iso, d, {.tolerance = 0.0006, .planeOfFace = planesOf(shape)});
  ASSERT_TRUE(facets) << facets.error().message;
  expectClosed(*facets);
  // The concave edge is rounded inwards: its quarter pipe is the only part that is not a plane.
  EXPECT_GT(facets->polygons.size(), 8u);
  EXPECT_LT(facets->polygons.size(), 60u);
  // Profile of the shrunk L with the round corner's spandrel.
  const double profile = 1.6 * 0.6 + 0.6 * 1.0 + 0.04 * (1 - kPi / 4);
  EXPECT_NEAR(volumeOf(*facets), 0.6 * profile, 0.6 * 0.4 * 0.0006 * kPi);  // band of tolerance
  EXPECT_LE(facets->maxDeviation, 0.0012);
}

TEST(Facet, GrownBoxKeepsPlanesAndSteinersVolume) {
  const TriMesh box = test::box(Vec3(0, 0, 0), Vec3(4, 3, 2));
  const SurfaceDistance surface = distanceTo(box);
  const double d = 0.5;
  const TriMesh outer = subdivided(test::box(Vec3(-.5, -.5, -.5), Vec3(4.5, 3.5, 2.5)), 6);
  const IsoSurface iso = projected(surface, outer, d);
  const auto facets =
      facetIsoSurface(surface, iso, d, {.tolerance = 0.003 * d, .planeOfFace = planesOf(box)});
  ASSERT_TRUE(facets) << facets.error().message;
  expectClosed(*facets);
  const double steiner = 24 + 52 * d + kPi * d * d * 9 + 4 * kPi / 3 * d * d * d;
  // Facets are chords: too small by at most the tolerance over the curved area.
  const double curved = 2 * kPi * d * 9 / 2 * 2 + 4 * kPi * d * d;
  EXPECT_LT(volumeOf(*facets), steiner);
  EXPECT_GT(volumeOf(*facets), steiner - 0.003 * d * curved);
  EXPECT_LE(facets->p99Deviation, 0.003 * d);
  EXPECT_LE(facets->maxDeviation, 0.006 * d);
  EXPECT_LT(facets->polygons.size(), 4000u);
  int large = 0;
  for (const FacetPolygon& polygon : facets->polygons) {
    if (polygon.loops[0].size() > 3) ++large;
  }
  EXPECT_EQ(large, 6);
}

TEST(Facet, SphereStaysWithinTolerance) {
  const SurfaceDistance surface = distanceTo(test::sphere(1, 5));
  const IsoSurface iso = projected(surface, test::sphere(1.5, 5), 0.5);
  const auto facets = facetIsoSurface(surface, iso, 0.5, {.tolerance = 0.005, .planeOfFace = {}});
  ASSERT_TRUE(facets) << facets.error().message;
  expectClosed(*facets);
  EXPECT_LT(facets->polygons.size(), 4000u);  // 8192 triangles came in
  EXPECT_LE(facets->p99Deviation, 0.005);
  EXPECT_NEAR(volumeOf(*facets), 4 * kPi / 3 * 3.375, 4 * kPi * 2.25 * 0.006);
}

TEST(Facet, CoarseInputIsRefined) {
  const SurfaceDistance surface = distanceTo(test::sphere(1, 6));
  const IsoSurface iso = projected(surface, test::sphere(1.5, 1), 0.5);
  const auto facets = facetIsoSurface(surface, iso, 0.5, {.tolerance = 0.005, .planeOfFace = {}});
  ASSERT_TRUE(facets) << facets.error().message;
  expectClosed(*facets);
  EXPECT_GT(facets->polygons.size(), 200u);  // 32 triangles came in
  EXPECT_LE(facets->p99Deviation, 0.0055);
}

TEST(Facet, MaxFacetsRaisesTheTolerance) {
  const SurfaceDistance surface = distanceTo(test::sphere(1, 5));
  const IsoSurface iso = projected(surface, test::sphere(1.5, 5), 0.5);
  const auto facets =
      facetIsoSurface(surface, iso, 0.5, {.tolerance = 0.001, .maxFacets = 300, .planeOfFace = {}});
  ASSERT_TRUE(facets) << facets.error().message;
  expectClosed(*facets);
  EXPECT_LE(facets->polygons.size(), 300u);
  EXPECT_GT(facets->maxDeviation, 0.001);
  EXPECT_LT(facets->maxDeviation, 0.2);
}

TEST(Facet, SameBitsAtAnyThreadCount) {
  const TriMesh box = test::box(Vec3(0, 0, 0), Vec3(4, 3, 2));
  const SurfaceDistance surface = distanceTo(box);
  const TriMesh outer = subdivided(test::box(Vec3(-.5, -.5, -.5), Vec3(4.5, 3.5, 2.5)), 5);
  const IsoSurface iso = projected(surface, outer, 0.5);
  FacetOptions options{.tolerance = 0.002, .planeOfFace = planesOf(box), .threads = 1};
  const auto one = facetIsoSurface(surface, iso, 0.5, options);
  options.threads = 4;
  const auto four = facetIsoSurface(surface, iso, 0.5, options);
  ASSERT_TRUE(one && four);
  ASSERT_EQ(one->points.size(), four->points.size());
  for (std::size_t i = 0; i < one->points.size(); ++i) {
    EXPECT_EQ(one->points[i], four->points[i]);
  }
  ASSERT_EQ(one->polygons.size(), four->polygons.size());
  for (std::size_t i = 0; i < one->polygons.size(); ++i) {
    EXPECT_EQ(one->polygons[i].loops, four->polygons[i].loops);
  }
  EXPECT_EQ(one->maxDeviation, four->maxDeviation);
}

TEST(Facet, RefusesNonsense) {
  const SurfaceDistance surface = distanceTo(test::sphere(1, 3));
  IsoSurface iso = projected(surface, test::sphere(1.5, 3), 0.5);
  EXPECT_EQ(facetIsoSurface(surface, iso, 0.5, FacetOptions()).error().code,
            ErrorCode::InvalidArgument);
  iso.mesh.triangles.pop_back();
  iso.mesh.faceOf.pop_back();
  EXPECT_EQ(facetIsoSurface(surface, iso, 0.5, {.tolerance = 0.01, .planeOfFace = {}}).error().code,
            ErrorCode::Failed);
  const auto nothing = facetIsoSurface(surface, {}, 0.5, {.tolerance = 0.01, .planeOfFace = {}});
  ASSERT_TRUE(nothing);
  EXPECT_TRUE(nothing->polygons.empty());
}

TEST(Facet, CancelsOnRequest) {
  const SurfaceDistance surface = distanceTo(test::sphere(1, 4));
  const IsoSurface iso = projected(surface, test::sphere(1.5, 4), 0.5);
  const Progress stop([](double fraction, std::string_view) { return fraction < 0.2; });
  const auto result =
      facetIsoSurface(surface, iso, 0.5, {.tolerance = 0.01, .planeOfFace = {}}, stop);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::Cancelled);
}

}  // namespace
}  // namespace phront
