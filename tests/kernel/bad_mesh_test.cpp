// Bad meshes on their way to a field: each is refused in one sentence that names the place, or
// gives the field of the sound mesh it stands for, and diagnose() tells what is wrong with it.
#include <gtest/gtest.h>

#include <limits>

#include "field_audit.h"
#include "meshes.h"
#include "phront/distance_field.h"

namespace phront {
namespace {

constexpr double kSpacing = 0.05;
constexpr double kBand = 0.4;
constexpr std::size_t kNodes = 2'000;
constexpr double kTolerance = 1e-13;  // round-off of feet on models of size 2
constexpr std::size_t kPatch = 40;    // triangles that are made bad

TriMesh unlabelled(TriMesh mesh) {
  mesh.faceOf.clear();
  mesh.edgeOf.clear();
  mesh.vertexOf.clear();
  return mesh;
}

/// Has feet inside and outside on edges and points, where signs are hardest.
TriMesh lShape() { return unlabelled(test::lShape()); }

/// Prism from the z axis along (x, y), with an edge of 33 degrees there: normals say little of the
/// side.
TriMesh wedge(double x, double y) {
  return unlabelled(test::prism({{0, 0}, {x + 0.3 * y, y - 0.3 * x}, {x - 0.3 * y, y + 0.3 * x}},
                                {{0, 1, 2}}, 0, 1));
}

TriMesh ball() { return unlabelled(test::icosphere(2)); }

std::array<Index, 3> reversed(const std::array<Index, 3>& t) { return {t[0], t[2], t[1]}; }

Result<DistanceField> fieldOf(const TriMesh& mesh) {
  const auto surface = SurfaceDistance::build(mesh);
  if (!surface) return tl::unexpected(surface.error());
  return solveDistanceField(*surface, {.spacing = kSpacing, .bandMin = -kBand, .bandMax = kBand});
}

void expectRefused(const TriMesh& mesh, const std::string& where, const std::string& word) {
  const auto field = fieldOf(mesh);
  ASSERT_FALSE(field.has_value());
  EXPECT_EQ(field.error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(field.error().where, where);
  EXPECT_NE(field.error().message.find(word), std::string::npos) << field.error().message;
}

/// Random nodes of a field against `sound`, by loops over its triangles.
test::FieldAudit auditAgainst(const TriMesh& sound, const DistanceField& field) {
  const auto nodes = test::randomNodes(field, kNodes, 1);
  EXPECT_EQ(nodes.size(), kNodes);
  const test::ReferenceDistance reference(sound);
  return test::auditField(field, nodes, reference, kTolerance,
                          [&](const Vec3& x) { return reference.windingNumber(x) > 0.5; });
}

void expectFieldOf(const TriMesh& sound, const TriMesh& mesh) {
  const auto field = fieldOf(mesh);
  ASSERT_TRUE(field.has_value()) << field.error().message;
  const test::FieldAudit audit = auditAgainst(sound, *field);
  EXPECT_EQ(audit.wrongDistance, 0);
  EXPECT_EQ(audit.wrongSign, 0);
  EXPECT_EQ(field->signRepairs(), 0);  // right from the start
  EXPECT_GT(audit.inside, static_cast<std::int64_t>(kNodes) / 40);
  EXPECT_GT(audit.outside, static_cast<std::int64_t>(kNodes) / 40);
}

TEST(BadMesh, NothingIsRefused) {
  expectRefused({}, "", "empty");
  TriMesh points = ball();
  points.triangles.clear();
  expectRefused(points, "", "empty");
}

TEST(BadMesh, PointsThatAreNoneOrTooFarAreNamed) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    TriMesh mesh = ball();
    mesh.points[17][1] = bad;
    EXPECT_EQ(diagnose(mesh).nonFinitePoints, 1);
    expectRefused(mesh, "point 17", "not finite");
  }
  TriMesh far = ball();
  far.points[17][1] = -1e200;  // its square overflows
  expectRefused(far, "point 17", "farther off");
}

TEST(BadMesh, IndicesOutOfRangeAreNamed) {
  for (const Index bad : {-1, 162, std::numeric_limits<Index>::min()}) {
    TriMesh mesh = ball();
    ASSERT_EQ(mesh.points.size(), 162U);
    mesh.triangles[7][2] = bad;
    EXPECT_EQ(diagnose(mesh).badIndices, 1);
    expectRefused(mesh, "triangle 7", std::to_string(bad));
  }
}

TEST(BadMesh, DuplicateTrianglesChangeNothing) {
  for (const TriMesh& sound : {ball(), lShape()}) {
    for (const std::size_t count : {std::size_t{5}, sound.triangles.size()}) {  // some, all
      TriMesh mesh = sound;
      for (std::size_t t = 0; t < count; ++t) mesh.triangles.push_back(sound.triangles[t]);
      EXPECT_GT(diagnose(mesh).nonManifoldEdges, 0);
      expectFieldOf(sound, mesh);
    }
  }
}

// A triangle and its reverse cancel: what they close is a hole, and what has a hole has no inside
// near it. Distances are right all the same.
TEST(BadMesh, DuplicatesBackToBackAreToldAndKeepDistances) {
  const TriMesh sound = ball();
  TriMesh mesh = sound;
  for (std::size_t t = 0; t < kPatch; ++t) mesh.triangles.push_back(reversed(sound.triangles[t]));
  EXPECT_GT(diagnose(mesh).nonManifoldEdges, 0);
  EXPECT_GT(diagnose(mesh).misorientedEdges, 0);
  const auto field = fieldOf(mesh);
  ASSERT_TRUE(field.has_value()) << field.error().message;
  EXPECT_EQ(auditAgainst(sound, *field).wrongDistance, 0);
}

TEST(BadMesh, TrianglesThatUseAPointTwiceChangeNothing) {
  const TriMesh sound = lShape();
  TriMesh mesh = sound;
  for (const auto& [a, b, c] : sound.triangles) {
    mesh.triangles.push_back({a, a, b});
    mesh.triangles.push_back({c, c, c});
  }
  EXPECT_EQ(diagnose(mesh).degenerateTriangles, static_cast<Index>(2 * sound.triangles.size()));
  expectFieldOf(sound, mesh);
}

TEST(BadMesh, TrianglesOnALineChangeNothing) {
  for (const TriMesh& sound : {lShape(), wedge(1, 0)}) {
    TriMesh mesh = sound;
    for (std::size_t t = 0; t < sound.triangles.size(); ++t) {  // T-junctions, closed
      const auto [a, b, c] = sound.triangles[t];
      const auto middle = static_cast<Index>(mesh.points.size());
      mesh.points.push_back(
          (sound.points[static_cast<std::size_t>(a)] + sound.points[static_cast<std::size_t>(b)]) /
          2);
      mesh.triangles[t] = {a, middle, c};
      mesh.triangles.push_back({middle, b, c});
      mesh.triangles.push_back({a, b, middle});
    }
    EXPECT_TRUE(diagnose(mesh).closedManifold());
    EXPECT_EQ(diagnose(mesh).degenerateTriangles, static_cast<Index>(sound.triangles.size()));
    expectFieldOf(sound, mesh);
  }
}

TEST(BadMesh, TurnedPatchesAreRefusedAndMendedByOrient) {
  const TriMesh sound = ball();
  for (const std::size_t count : {std::size_t{1}, std::size_t{4}, kPatch}) {
    TriMesh mesh = sound;
    for (std::size_t t = 0; t < count; ++t) {
      auto& triangle = mesh.triangles[t];
      triangle = reversed(triangle);
    }
    EXPECT_GT(diagnose(mesh).misorientedEdges, 0);
    const auto refused = SurfaceDistance::build(mesh);
    ASSERT_FALSE(refused.has_value());
    EXPECT_EQ(refused.error().code, ErrorCode::InvalidArgument);
    EXPECT_TRUE(refused.error().where.starts_with("triangle ")) << refused.error().where;
    EXPECT_NE(refused.error().message.find("disagree"), std::string::npos);
    const OrientedMesh mended = orient(mesh);
    EXPECT_EQ(mended.turned, static_cast<Index>(count));
    expectFieldOf(sound, mended.mesh);
  }
}

// The wedges are the harder case: their edge is the nearest place to points behind it, where some
// of its faces look away.
TEST(BadMesh, SolidsThatShareAnEdgeGiveTheFieldOfBoth) {
  for (const auto& [one, other] :
       {std::pair{test::box(Vec3(0, 0, 0), Vec3(1, 1, 1)), test::box(Vec3(1, 1, 0), Vec3(2, 2, 1))},
        {wedge(0, 1), wedge(1, 0)}}) {
    TriMesh mesh;
    test::append(mesh, one);
    test::append(mesh, other);
    mesh = weld(mesh);
    EXPECT_EQ(diagnose(mesh).nonManifoldEdges, 1);
    expectFieldOf(mesh, mesh);
  }
}

}  // namespace
}  // namespace phront
