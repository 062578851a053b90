// Is the field of real parts exact? Nodes around three parts of different kind against loops over
// the triangles of their tessellation: |phi| against the least distance, the sign against the sum
// of all solid angles. Skipped where the corpus is absent.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>

#include "field_audit.h"
#include "phront/cad/exchange.h"
#include "phront/cad/tessellate.h"

namespace phront::cad {
namespace {

constexpr std::size_t kNodes = 100'000;
constexpr std::size_t kSigns = 2'000;  // each sums over all triangles
constexpr double kDeflection = 1e-4;   // of the diagonal: slivers on fillets and around holes
constexpr double kSpacing = 1e-2;      // of the diagonal: several hundred tiles
constexpr double kBandCells = 3;
// Round-off of a foot and of the distance to it: some tens of ulps of the coordinates.
constexpr double kTolerance = 1e-12;  // of the diagonal

class FieldAuditCorpus : public testing::TestWithParam<const char*> {};

TEST_P(FieldAuditCorpus, FieldIsExact) {
  const auto file =
      std::filesystem::path(PHRONT_SOURCE_DIR) / ".." / "shared" / "corpus" / GetParam();
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no corpus beside the sources";
  const auto model = readModel(file);
  ASSERT_TRUE(model) << model.error().message;
  ASSERT_EQ(model->bodies.size(), 1U);
  const double diagonal = boundingBox(model->bodies[0].shape).diagonal().norm();
  auto tessellation = tessellate(model->bodies[0], {.deflection = kDeflection * diagonal});
  ASSERT_TRUE(tessellation) << tessellation.error().message;
  ASSERT_TRUE(diagnose(tessellation->mesh).closedManifold());
  const test::ReferenceDistance reference(tessellation->mesh);
  const auto surface = SurfaceDistance::build(std::move(tessellation->mesh));
  ASSERT_TRUE(surface) << surface.error().message;
  const double spacing = kSpacing * diagonal;
  const double band = kBandCells * spacing;
  const auto field =
      solveDistanceField(*surface, {.spacing = spacing, .bandMin = -band, .bandMax = band});
  ASSERT_TRUE(field) << field.error().message;
  const auto nodes = test::randomNodes(*field, kNodes, 1);
  ASSERT_EQ(nodes.size(), kNodes);

  // The reference's own search against its plain loop.
  for (std::size_t i = 0; i < 20; ++i) {
    const Vec3 x = field->position(nodes[i]);
    EXPECT_EQ(reference.distance(x), reference.distanceByLoop(x));
  }
  // The loop over solid angles is for the first nodes only; the nodes are random anyway.
  std::size_t signs = 0;
  const test::FieldAudit audit = test::auditField(*field, nodes, reference, kTolerance * diagonal,
                                                  [&](const Vec3& x) -> std::optional<bool> {
                                                    if (signs++ >= kSigns) return std::nullopt;
                                                    return reference.windingNumber(x) > 0.5;
                                                  });
  std::printf("%zu triangles, %zu tiles: largest error %.3g of the diagonal, %lld + %lld signs\n",
              surface->mesh().triangles.size(), field->tiles().size(),
              audit.largestError / diagonal, static_cast<long long>(audit.inside),
              static_cast<long long>(audit.outside));
  EXPECT_EQ(audit.wrongDistance, 0);
  EXPECT_EQ(audit.wrongSign, 0);
  EXPECT_GT(audit.inside, static_cast<std::int64_t>(kSigns) / 20);
  EXPECT_GT(audit.outside, static_cast<std::int64_t>(kSigns) / 20);
  EXPECT_EQ(field->signRepairs(), 0);
}

INSTANTIATE_TEST_SUITE_P(Parts, FieldAuditCorpus,
                         testing::Values("gmsh__Angled.step",       // prismatic, many holes
                                         "occt__screw.step",        // turned
                                         "thor__GripperArm.step"),  // filleted
                         [](const auto& part) {
                           const std::string name(part.param);
                           return name.substr(name.rfind('_') + 1,
                                              name.find('.') - name.rfind('_') - 1);
                         });

}  // namespace
}  // namespace phront::cad
