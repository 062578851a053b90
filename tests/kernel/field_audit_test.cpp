// Is the field exact? Nodes of large generated meshes against loops over their triangles.
#include <gtest/gtest.h>

#include <cstdio>

#include "field_audit.h"
#include "meshes.h"
#include "phront/distance_field.h"

namespace phront {
namespace {

constexpr std::size_t kNodes = 100'000;
constexpr double kBandCells = 3;
// Round-off of a foot and of the distance to it: some tens of ulps of the coordinates.
constexpr double kTolerance = 1e-12;  // of the diagonal

/// |phi| at random nodes of a band against the loop; the sign against `analytic`, the distance to
/// the smooth surface that the mesh stands for, wherever that is larger than `sag`, by which the
/// two surfaces may differ.
void expectExactField(TriMesh mesh, double spacing,
                      const std::function<double(const Vec3&)>& analytic, double sag) {
  const test::ReferenceDistance reference(mesh);
  const auto triangles = mesh.triangles.size();
  const auto surface = SurfaceDistance::build(std::move(mesh));
  ASSERT_TRUE(surface.has_value()) << surface.error().message;
  const double band = kBandCells * spacing;
  const auto field =
      solveDistanceField(*surface, {.spacing = spacing, .bandMin = -band, .bandMax = band});
  ASSERT_TRUE(field.has_value()) << field.error().message;
  const auto nodes = test::randomNodes(*field, kNodes, 1);
  ASSERT_EQ(nodes.size(), kNodes);

  // The reference's own search against its plain loop.
  for (std::size_t i = 0; i < 20; ++i) {
    const Vec3 x = field->position(nodes[i]);
    EXPECT_EQ(reference.distance(x), reference.distanceByLoop(x));
  }
  const double tolerance = kTolerance * surface->box().diagonal().norm();
  const test::FieldAudit audit = test::auditField(*field, nodes, reference, tolerance,
                                                  [&](const Vec3& x) -> std::optional<bool> {
                                                    const double phi = analytic(x);
                                                    if (std::abs(phi) <= sag) return std::nullopt;
                                                    return phi < 0;
                                                  });
  std::printf("%zu triangles, %zu tiles: largest error %.3g of the diagonal, %lld signs\n",
              triangles, field->tiles().size(),
              audit.largestError / surface->box().diagonal().norm(),
              static_cast<long long>(audit.inside + audit.outside));
  EXPECT_EQ(audit.wrongDistance, 0);
  EXPECT_EQ(audit.wrongSign, 0);
  EXPECT_GT(audit.inside, static_cast<std::int64_t>(kNodes) / 4);
  EXPECT_GT(audit.outside, static_cast<std::int64_t>(kNodes) / 4);
  EXPECT_EQ(field->signRepairs(), 0);
}

double spherePhi(const Vec3& x) { return x.norm() - 1; }

/// How far the flat triangles of a mesh of the unit sphere lie below it.
double sphereSag(const TriMesh& mesh) {
  double sag = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3& a = mesh.points[static_cast<std::size_t>(t[0])];
    const Vec3& b = mesh.points[static_cast<std::size_t>(t[1])];
    const Vec3& c = mesh.points[static_cast<std::size_t>(t[2])];
    sag = std::max(sag, 1 - std::abs(a.dot((b - a).cross(c - a).normalized())));
  }
  return sag;
}

TEST(FieldAudit, SphereOfTwentyThousandTriangles) {
  const TriMesh mesh = test::icosphere(5);
  ASSERT_EQ(mesh.triangles.size(), 20'480U);
  expectExactField(mesh, 0.02, spherePhi, sphereSag(mesh));
}

TEST(FieldAudit, SphereOfThreeHundredThousandTriangles) {
  const TriMesh mesh = test::icosphere(7);
  ASSERT_EQ(mesh.triangles.size(), 327'680U);
  expectExactField(mesh, 0.02, spherePhi, sphereSag(mesh));
}

TEST(FieldAudit, TorusOfHalfAMillionTriangles) {
  const double major = 2;
  const double minor = 0.6;
  const Index around = 700;
  const Index across = 358;
  const TriMesh mesh = test::torus(major, minor, around, across);
  ASSERT_EQ(mesh.triangles.size(), 501'200U);
  // Linear interpolation over a right triangle with legs u, v errs by (u^2 + v^2) / 8 times the
  // second derivative at most; those of the torus are R + r along u, r along v and r mixed.
  const double u = 2 * std::numbers::pi / around;
  const double v = 2 * std::numbers::pi / across;
  const double sag = (u * u + v * v) / 8 * (major + minor + 2 * minor + minor);
  expectExactField(
      mesh, 0.04,
      [&](const Vec3& x) { return std::hypot(std::hypot(x[0], x[1]) - major, x[2]) - minor; }, sag);
}

}  // namespace
}  // namespace phront
