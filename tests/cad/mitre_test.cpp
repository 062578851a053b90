// Mitre joins whose volume is known: every plane and cylinder moves by d, nothing is added.
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <TopExp_Explorer.hxx>
#include <gp_Vec.hxx>

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "phront/cad/offset_shape.h"
#include "phront/cad/shape_occt.h"
#include "solids.h"

namespace phront::cad {
namespace {

constexpr double kPi = std::numbers::pi;

Model modelOf(const TopoDS_Shape& shape) {
  Model model;
  model.bodies.push_back(test::solidBody(shape));
  return model;
}

TopoDS_Shape boxFrom(double low, double x, double y, double z) {
  return BRepPrimAPI_MakeBox(gp_Pnt(low, low, low), gp_Pnt(x, y, z)).Solid();
}

/// Prism of height 10 over a triangle with two sides of 20 and the angle between them (rad).
TopoDS_Shape wedge(double angle) {
  BRepBuilderAPI_MakePolygon polygon;
  polygon.Add(gp_Pnt(0, 0, 0));
  polygon.Add(gp_Pnt(20, 0, 0));
  polygon.Add(gp_Pnt(20 * std::cos(angle), 20 * std::sin(angle), 0));
  polygon.Close();
  const TopoDS_Shape prism =
      BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(polygon.Wire()).Face(), gp_Vec(0, 0, 10));
  return TopExp_Explorer(prism, TopAbs_SOLID).Current();
}

/// Its offset with all corners sharp: the triangle grows about the centre of its incircle.
double sharpWedgeVolume(double angle, double d) {
  const double area = 200 * std::sin(angle);
  const double inradius = 2 * area / (40 + 40 * std::sin(angle / 2));
  const double scale = (inradius + d) / inradius;
  return area * scale * scale * (10 + 2 * d);
}

OffsetResult mitre(const TopoDS_Shape& shape, double distance, double limit = kMitreLimit) {
  OffsetOptions options;
  options.distance = distance;
  options.join = Join::Mitre;
  options.mitreLimit = limit;
  Result<OffsetResult> made = offsetModel(modelOf(shape), options);
  EXPECT_TRUE(made) << (made ? "" : made.error().message);
  return made ? std::move(*made) : OffsetResult();
}

void expectMitre(const TopoDS_Shape& shape, double distance, double volume, int faces) {
  const OffsetResult made = mitre(shape, distance);
  ASSERT_TRUE(made.accepted()) << made.report.check.reasons.front();
  ASSERT_EQ(made.model.bodies.size(), 1U);
  EXPECT_EQ(made.report.bodies[0].roundedFaces, 0);
  EXPECT_TRUE(made.report.warnings.empty());
  EXPECT_EQ(faceCount(made.model.bodies[0].shape), faces);
  EXPECT_NEAR(made.report.check.volume, volume, 1e-6 * volume);
}

TEST(Mitre, BoxStaysABox) { expectMitre(test::box(10, 20, 30), 2, 14 * 24 * 34, 6); }

TEST(Mitre, CylinderStaysACylinder) { expectMitre(test::cylinder(5, 10), 1, kPi * 36 * 12, 3); }

TEST(Mitre, ConcaveEdgesAreSharpBothWays) {
  expectMitre(test::lShape(), 0.3, (2.6 * 2.6 - 1) * 1.6, 8);
  expectMitre(test::lShape(), -0.2, (1.6 * 1.6 - 1) * 0.6, 8);
}

TEST(Mitre, CornersBeyondTheLimitStayRound) {
  const double angle = kPi / 9;  // its mitre reaches to 5.8 d
  const OffsetResult made = mitre(wedge(angle), 1);
  ASSERT_TRUE(made.accepted()) << made.report.check.reasons.front();
  EXPECT_GT(made.report.bodies[0].roundedFaces, 0);
  EXPECT_FALSE(made.report.warnings.empty());
  EXPECT_LT(made.report.check.volume, sharpWedgeVolume(angle, 1));

  const OffsetResult far = mitre(wedge(angle), 1, 7);
  ASSERT_TRUE(far.accepted()) << far.report.check.reasons.front();
  EXPECT_EQ(far.report.bodies[0].roundedFaces, 0);
  EXPECT_NEAR(far.report.check.volume, sharpWedgeVolume(angle, 1), 1e-6 * far.report.check.volume);
}

TEST(Mitre, SheetsStayRoundAndSaySo) {
  Model model;
  Body sheet = test::solidBody(TopExp_Explorer(test::box(10, 10, 10), TopAbs_FACE).Current());
  sheet.kind = BodyKind::Sheet;
  model.bodies.push_back(sheet);
  OffsetOptions options;
  options.distance = 1;
  options.join = Join::Mitre;
  const auto made = offsetModel(model, options);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_TRUE(made->accepted());
  EXPECT_EQ(made->report.bodies[0].roundedFaces, 1);
  EXPECT_FALSE(made->report.warnings.empty());
}

TEST(Mitre, CheckKnowsTheJoin) {
  const Model part = modelOf(test::box(10, 10, 10));
  const TopoDS_Shape sharp = boxFrom(-1, 11, 11, 11);
  CheckOptions options;
  options.distance = 1;
  const auto asArc = checkOffset(part, modelOf(sharp), options);
  ASSERT_TRUE(asArc);
  EXPECT_FALSE(asArc->pass());
  options.join = Join::Mitre;
  const auto asMitre = checkOffset(part, modelOf(sharp), options);
  ASSERT_TRUE(asMitre);
  EXPECT_TRUE(asMitre->pass()) << asMitre->reasons.front();
  EXPECT_LT(asMitre->accuracyMax, 1e-6);
}

TEST(Mitre, CheckRefusesWhatIsNone) {
  const Model part = modelOf(test::box(10, 10, 10));
  CheckOptions options;
  options.distance = 1;
  options.join = Join::Mitre;
  const TopoDS_Shape lump = BRepPrimAPI_MakeBox(gp_Pnt(4, 4, 10), gp_Pnt(6, 6, 11.5)).Solid();
  const TopoDS_Shape withLump =
      TopExp_Explorer(BRepAlgoAPI_Fuse(boxFrom(-1, 11, 11, 11), lump).Shape(), TopAbs_SOLID)
          .Current();
  const TopoDS_Shape tooFar = boxFrom(-1, 12.5, 11, 11);  // on one side
  const TopoDS_Shape tooNear = boxFrom(-1, 10.9, 11, 11);
  for (const TopoDS_Shape& wrong : {withLump, tooFar, tooNear}) {
    const auto check = checkOffset(part, modelOf(wrong), options);
    ASSERT_TRUE(check);
    EXPECT_FALSE(check->pass());
  }
}

TEST(Mitre, NonsenseLimitsAreRefused) {
  for (const double limit : {1.0, -2.0, std::numeric_limits<double>::quiet_NaN()}) {
    OffsetOptions options;
    options.distance = 1;
    options.mitreLimit = limit;
    const auto made = offsetModel(modelOf(test::box(1, 1, 1)), options);
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, ErrorCode::InvalidArgument);
  }
}

}  // namespace
}  // namespace phront::cad
