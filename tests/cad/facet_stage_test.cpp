// Facets of the whole front, of solids and of sheets.
#include "rebuild/facet_stage.h"

#include <gtest/gtest.h>
#include <BRepPrimAPI_MakeCylinder.hxx>

#include <memory>
#include <numbers>

#include "exchange/measures.h"
#include "solids.h"
#include "tessellate/body_distance.h"

namespace phront::cad {
namespace {

OffsetOptions optionsFor(double distance, double tolerance) {
  OffsetOptions options;
  options.distance = distance;
  options.tolerance = tolerance;
  options.threads = 1;
  return options;
}

std::shared_ptr<const TrueDistance> phiOf(const Body& body, double distance) {
  return std::make_shared<const TrueDistance>(*distanceOf(body, distance, 30, 2));
}

Body sheetBody(const TopoDS_Shape& face) {
  Body body;
  body.kind = BodyKind::Sheet;
  body.shape = makeShape(face);
  return body;
}

TEST(FacetBody, PassesAndIsClosedWhereCoarse) {
  const Body body = test::solidBody(test::filletedBox(10, 2));
  const OffsetOptions options = optionsFor(1, 0.03);
  const auto phi = phiOf(body, 1);
  const BodyCheck check = *BodyCheck::make(body, body, phi, 1, 30);
  const Result<FacetAttempt> fine = facetBody(body, options, *phi, check, Deadline(60), {});
  ASSERT_TRUE(fine) << fine.error().message;
  EXPECT_TRUE(fine->file.check.pass()) << fine->file.check.reasons.front();
  EXPECT_NE(fine->file.fingerprint, 0U);
  EXPECT_EQ(fine->planarFaces, 6);
  EXPECT_GT(fine->facets, 100);

  const FacetAttempt coarse = coarseFacets(body, options, *phi, check, Deadline(60));
  EXPECT_FALSE(coarse.file.check.pass());
  EXPECT_TRUE(coarse.file.check.valid);
  EXPECT_TRUE(coarse.file.check.closed);
  ASSERT_EQ(coarse.bodies.size(), 1U);
  EXPECT_LT(coarse.facets, fine->facets);

  const Progress cancel([](double, std::string_view) { return false; });
  const Result<FacetAttempt> cancelled =
      facetBody(body, options, *phi, check, Deadline(60), cancel);
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().code, ErrorCode::Cancelled);
}

TEST(FacetBody, ASheetEndsWhereItsEdgesAreOffset) {
  // A cylinder without its ends, and a quarter of it.
  for (const double angle : {2 * std::numbers::pi, std::numbers::pi / 2}) {
    BRepPrimAPI_MakeCylinder cylinder(10, 20, angle);
    const Body body = sheetBody(cylinder.Cylinder().LateralFace());
    for (const double d : {2.0, -2.0}) {
      const auto phi = phiOf(body, d);
      const BodyCheck check = *BodyCheck::make(body, body, phi, d, 30);
      const Result<FacetAttempt> facets =
          facetBody(body, optionsFor(d, 0.15), *phi, check, Deadline(60), {});
      ASSERT_TRUE(facets) << facets.error().message;
      ASSERT_TRUE(facets->file.check.pass()) << facets->file.check.reasons.front();
      ASSERT_EQ(facets->bodies.size(), 1U);
      EXPECT_EQ(facets->bodies.front().kind, BodyKind::Sheet);
      const double area = angle * (10 + d) * 20;
      EXPECT_NEAR(areaOf(occtShape(facets->bodies.front().shape)), area, 0.02 * area);
    }
  }
}

TEST(FacetBody, SaysWhenNothingOfASheetIsLeft) {
  // Inside a cylinder with a slit no point is farther than its radius.
  BRepPrimAPI_MakeCylinder cylinder(1, 20, 5.5);
  const Body body = sheetBody(cylinder.Cylinder().LateralFace());
  const auto phi = phiOf(body, -1.5);
  const BodyCheck check = *BodyCheck::make(body, body, phi, -1.5, 30);
  const Result<FacetAttempt> facets =
      facetBody(body, optionsFor(-1.5, 0.02), *phi, check, Deadline(60), {});
  ASSERT_TRUE(facets) << facets.error().message;
  EXPECT_TRUE(facets->bodies.empty());
  EXPECT_TRUE(facets->file.check.pass());
}

}  // namespace
}  // namespace phront::cad
