// Intersection curves spoilt on purpose, of an oblique plane and half a cylinder.
#include "rebuild/section_curves.h"

#include <gtest/gtest.h>
#include <BOPAlgo_PaveFiller.hxx>
#include <BOPDS_Curve.hxx>
#include <BOPDS_Interf.hxx>
#include <BOPDS_VectorOfInterfFF.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_BezierCurve.hxx>
#include <IntTools_Curve.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TopTools_ListOfShape.hxx>
#include <gp_Ax3.hxx>
#include <gp_Cylinder.hxx>
#include <gp_Pln.hxx>
#include <gp_Vec2d.hxx>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace phront::cad {
namespace {

constexpr double kRadius = 10;
constexpr double kDoubtful = 1e-5;

class SectionCurves : public testing::Test {
 protected:
  void SetUp() override {
    TopTools_ListOfShape faces;
    const gp_Cylinder cylinder(gp_Ax3(), kRadius);
    faces.Append(BRepBuilderAPI_MakeFace(cylinder, 0.3, std::numbers::pi, -20, 20).Face());
    faces.Append(
        BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(), gp_Dir(0.3, 0, 1)), -40, 40, -40, 40).Face());
    filler_.SetArguments(faces);
    filler_.Perform();
    ASSERT_FALSE(filler_.HasErrors());
    ASSERT_EQ(filler_.PDS()->InterfFF().Length(), 1);
    ASSERT_EQ(curves().Length(), 1);
    double first = 0;
    double last = 0;
    ASSERT_TRUE(curve().Curve().Bounds(first, last, from_, to_));
  }

  BOPDS_VectorOfCurve& curves() { return filler_.PDS()->InterfFF()(0).ChangeCurves(); }
  BOPDS_Curve& curve() { return curves()(0); }
  int settle() { return settleSectionCurves(*filler_.PDS(), filler_.Context(), kDoubtful); }

  /// Swings out by `height` between its ends.
  void spoil(const gp_Pnt& from, const gp_Pnt& to, double height) {
    TColgp_Array1OfPnt poles(1, 3);
    poles(1) = from;
    poles(2) = gp_Pnt(gp_Vec(from.XYZ() + to.XYZ()).XYZ() / 2 + gp_XYZ(0, 2 * height, 0));
    poles(3) = to;
    curve().SetCurve(IntTools_Curve(new Geom_BezierCurve(poles), {}, {}));
    curve().SetTolerance(2 * height);
  }

  /// Largest distance of the curve from the cylinder and from the plane.
  double offBoth() {
    const IntTools_Curve& c = curve().Curve();
    double first = 0;
    double last = 0;
    gp_Pnt from;
    gp_Pnt to;
    EXPECT_TRUE(c.Bounds(first, last, from, to));
    double off = 0;
    for (int i = 0; i <= 100; ++i) {
      const gp_Pnt p = c.Curve()->Value(std::lerp(first, last, i / 100.0));
      off = std::max({off, std::abs(std::hypot(p.X(), p.Y()) - kRadius),
                      std::abs(0.3 * p.X() + p.Z()) / std::hypot(0.3, 1)});
    }
    return off;
  }

  BOPAlgo_PaveFiller filler_;
  gp_Pnt from_;
  gp_Pnt to_;
};

TEST_F(SectionCurves, GoodOnesStay) {
  EXPECT_LT(curve().Tolerance(), kDoubtful);
  EXPECT_EQ(settle(), 0);
}

TEST_F(SectionCurves, ToleranceIsWhatIsMeasured) {
  curve().SetTolerance(5);
  EXPECT_EQ(settle(), 1);
  EXPECT_LT(curve().Tolerance(), kDoubtful);
}

TEST_F(SectionCurves, ImagesThatAreOffAreLeftToBeMadeAnew) {
  IntTools_Curve shifted = curve().Curve();
  ASSERT_FALSE(shifted.FirstCurve2d().IsNull());
  const Handle(Geom2d_Curve) image =
      Handle(Geom2d_Curve)::DownCast(shifted.FirstCurve2d()->Translated(gp_Vec2d(0, 1)));
  shifted.SetFirstCurve2d(image);
  curve().SetCurve(shifted);
  curve().SetTolerance(5);
  EXPECT_EQ(settle(), 1);
  EXPECT_LT(curve().Tolerance(), kDoubtful);
  EXPECT_TRUE(curve().Curve().FirstCurve2d().IsNull());
  EXPECT_FALSE(curve().Curve().SecondCurve2d().IsNull());
}

TEST_F(SectionCurves, ShortOnesThatSwingOutBecomeStraight) {
  double first = 0;
  double last = 0;
  ASSERT_TRUE(curve().Curve().Bounds(first, last, from_, to_));
  const gp_Pnt near = curve().Curve().Curve()->Value(std::lerp(first, last, 1e-4));
  spoil(from_, near, 50);
  ASSERT_GT(offBoth(), 10);
  EXPECT_EQ(settle(), 1);
  EXPECT_LT(offBoth(), 1e-6);
  EXPECT_LT(curve().Tolerance(), 1e-5);
}

TEST_F(SectionCurves, LongOnesThatSwingOutAreFoundAgain) {
  spoil(from_, to_, 50);
  ASSERT_GT(offBoth(), 10);
  EXPECT_EQ(settle(), 1);
  ASSERT_EQ(curves().Length(), 1);
  EXPECT_LT(offBoth(), 1e-5);
  EXPECT_LT(curve().Tolerance(), kDoubtful);
}

}  // namespace
}  // namespace phront::cad
