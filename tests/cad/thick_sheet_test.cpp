// Sheets given a thickness, against volumes by formula, and their judge against wrong ones.
#include <gtest/gtest.h>

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <GeomAPI_PointsToBSplineSurface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Plane.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <cmath>
#include <numbers>

#include "phront/cad/shell_shape.h"
#include "solids.h"

namespace phront::cad {
namespace {

using std::numbers::pi;

Model sheetModel(const TopoDS_Shape& shape) {
  Body body;
  body.shape = makeShape(shape);
  body.kind = BodyKind::Sheet;
  Model model;
  model.bodies.push_back(body);
  return model;
}

ShellOptions thickness(double t, ShellSide side) {
  ShellOptions options;
  options.thickness = t;
  options.side = side;
  return options;
}

/// Volume of the thickened sheet, which must pass.
double volumeOf(const Model& model, double t, ShellSide side) {
  const Result<ShellResult> made = shellModel(model, thickness(t, side));
  if (!made) {
    ADD_FAILURE() << made.error().message;
    return 0;
  }
  for (const std::string& reason : made->report.check.reasons) ADD_FAILURE() << reason;
  return made->report.check.volume;
}

/// 20 x 30 in z = 0, normal +z.
TopoDS_Shape plate() {
  return BRepBuilderAPI_MakeFace(new Geom_Plane(gp::XOY()), 0, 20, 0, 30, 1e-7).Face();
}

/// Radius 10, height 20, `angle` round it, normal outwards.
TopoDS_Shape tube(double angle) {
  return BRepBuilderAPI_MakeFace(new Geom_CylindricalSurface(gp::XOY(), 10), 0, angle, 0, 20, 1e-7)
      .Face();
}

TopoDS_Shape rectangle(const gp_Pnt& a, const gp_Pnt& b, const gp_Pnt& c, const gp_Pnt& d) {
  return BRepBuilderAPI_MakeFace(BRepBuilderAPI_MakePolygon(a, b, c, d, true).Wire(), true).Face();
}

TopoDS_Shape sewn(const std::vector<TopoDS_Shape>& faces) {
  BRepBuilderAPI_Sewing sewing(1e-6);
  sewing.SetNonManifoldMode(true);
  for (const TopoDS_Shape& face : faces) sewing.Add(face);
  sewing.Perform();
  return sewing.SewedShape();
}

/// 20 x 10 in z = 0 and a face upright from its far edge, 10 high and narrower by `lean` at either
/// end of its top: normals up and towards -y, so that the fold is concave on the side of the
/// normals.
TopoDS_Shape angle(double lean) {
  return sewn({rectangle(gp_Pnt(0, 0, 0), gp_Pnt(20, 0, 0), gp_Pnt(20, 10, 0), gp_Pnt(0, 10, 0)),
               rectangle(gp_Pnt(0, 10, 0), gp_Pnt(20, 10, 0), gp_Pnt(20 - lean, 10, 10),
                         gp_Pnt(lean, 10, 10))});
}

TEST(ThickSheet, Plate) {
  const Model model = sheetModel(plate());
  for (const ShellSide side : {ShellSide::In, ShellSide::Out, ShellSide::Both})
    EXPECT_NEAR(volumeOf(model, 2, side), 1200, 1e-6);
}

TEST(ThickSheet, CylinderPatchAndTube) {
  for (const double angle : {0.5 * pi, 2 * pi}) {
    const Model model = sheetModel(tube(angle));
    EXPECT_NEAR(volumeOf(model, 1, ShellSide::Out), angle * 10 * (121 - 100), 1e-5);
    EXPECT_NEAR(volumeOf(model, 1, ShellSide::In), angle * 10 * (100 - 81), 1e-5);
    EXPECT_NEAR(volumeOf(model, 2, ShellSide::Both), angle * 10 * (121 - 81), 1e-5);
  }
}

TEST(ThickSheet, HemisphereStandsOnACone) {
  const TopoDS_Shape sphere = BRepPrimAPI_MakeSphere(10, 0, pi / 2).Shell();
  TopExp_Explorer faces(sphere, TopAbs_FACE);
  for (; faces.More(); faces.Next())
    if (BRepAdaptor_Surface(TopoDS::Face(faces.Current())).GetType() == GeomAbs_Sphere) break;
  const Model model = sheetModel(faces.Current());
  EXPECT_NEAR(volumeOf(model, 1, ShellSide::Out), 2 * pi / 3 * (1331 - 1000), 1e-4);
  EXPECT_NEAR(volumeOf(model, 1, ShellSide::In), 2 * pi / 3 * (1000 - 729), 1e-4);
}

TEST(ThickSheet, FoldIsRoundedOutsideAndSharpInside) {
  const Model model = sheetModel(angle(0));
  const double faces = 2 * 20 * 10;
  EXPECT_NEAR(volumeOf(model, 1, ShellSide::In), faces + 20 * pi / 4, 1e-6);
  EXPECT_NEAR(volumeOf(model, 1, ShellSide::Out), faces - 20, 1e-6);
  EXPECT_NEAR(volumeOf(model, 2, ShellSide::Both), 2 * faces + 20 * (pi / 4 - 1), 1e-6);
}

TEST(ThickSheet, WallsAtAFoldNeedNotLieInOnePlane) {
  const Model model = sheetModel(angle(3));
  const double upright = 10 * (20 - 3);
  EXPECT_NEAR(volumeOf(model, 1, ShellSide::In), 200 + upright + 20 * pi / 4, 1e-6);
}

TEST(ThickSheet, OpenBox) {
  std::vector<TopoDS_Shape> faces;
  for (TopExp_Explorer f(test::box(20, 30, 10), TopAbs_FACE); f.More(); f.Next()) {
    const TopoDS_Face face = TopoDS::Face(f.Current());
    const gp_Pnt middle = BRepAdaptor_Surface(face).Value(0, 0);
    if (faces.size() < 5 || middle.Z() < 9) faces.push_back(face);
  }
  faces.resize(5);
  const Model model = sheetModel(sewn(faces));
  const Result<ShellResult> made = shellModel(model, thickness(1, ShellSide::Both));
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_TRUE(made->accepted()) << made->report.check.reasons.front();
}

TEST(ThickSheet, FreeformPatch) {
  TColgp_Array2OfPnt points(1, 7, 1, 7);
  for (int i = 1; i <= 7; ++i)
    for (int j = 1; j <= 7; ++j)
      points.SetValue(i, j, gp_Pnt(5 * i, 5 * j, 3 * std::sin(0.6 * i) * std::cos(0.5 * j)));
  const Model model = sheetModel(
      BRepBuilderAPI_MakeFace(GeomAPI_PointsToBSplineSurface(points).Surface(), 1e-6).Face());
  for (const ShellSide side : {ShellSide::In, ShellSide::Out, ShellSide::Both})
    EXPECT_GT(volumeOf(model, 0.5, side), 450);
}

TEST(ThickSheet, RefusesOpenFacesAndFoldsOfThree) {
  const Model model = sheetModel(plate());
  ShellOptions options = thickness(1, ShellSide::Out);
  options.open = {{0, 0}};
  EXPECT_EQ(shellModel(model, options).error().code, ErrorCode::InvalidArgument);

  const Model three = sheetModel(
      sewn({rectangle(gp_Pnt(0, 0, 0), gp_Pnt(9, 0, 0), gp_Pnt(9, 9, 0), gp_Pnt(0, 9, 0)),
            rectangle(gp_Pnt(9, 0, 0), gp_Pnt(18, 0, 0), gp_Pnt(18, 9, 0), gp_Pnt(9, 9, 0)),
            rectangle(gp_Pnt(9, 0, 0), gp_Pnt(9, 0, 9), gp_Pnt(9, 9, 9), gp_Pnt(9, 9, 0))}));
  const Result<ShellResult> made = shellModel(three, thickness(1, ShellSide::Out));
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::NotSupported);
}

class ThickSheetCheck : public ::testing::Test {
 protected:
  [[nodiscard]] bool passes(const TopoDS_Shape& solid, double t, ShellSide side) const {
    Model out;
    out.bodies.push_back(test::solidBody(solid));
    const Result<CheckResult> check = checkShell(model_, out, thickness(t, side));
    EXPECT_TRUE(check) << check.error().message;
    return check && check->pass();
  }
  [[nodiscard]] static TopoDS_Shape block(double dz) {
    return BRepPrimAPI_MakePrism(plate(), gp_Vec(0, 0, dz)).Shape();
  }

  const Model model_ = sheetModel(plate());
};

TEST_F(ThickSheetCheck, AcceptsTheBlock) {
  EXPECT_TRUE(passes(block(2), 2, ShellSide::Out));
  EXPECT_TRUE(passes(block(-2), 2, ShellSide::In));
}

TEST_F(ThickSheetCheck, RefusesOtherThicknessAndSide) {
  EXPECT_FALSE(passes(block(2.04), 2, ShellSide::Out));
  EXPECT_FALSE(passes(block(2), 2, ShellSide::In));
  EXPECT_FALSE(passes(block(2), 2, ShellSide::Both));
}

TEST_F(ThickSheetCheck, RefusesSlantedWalls) {
  const TopoDS_Shape slanted = BRepPrimAPI_MakePrism(plate(), gp_Vec(0.2, 0, 2)).Shape();
  EXPECT_FALSE(passes(slanted, 2, ShellSide::Out));
}

TEST_F(ThickSheetCheck, RefusesAMissingPart) {
  const TopoDS_Shape part = BRepPrimAPI_MakeBox(20, 29, 2).Solid();
  EXPECT_FALSE(passes(part, 2, ShellSide::Out));
}

}  // namespace
}  // namespace phront::cad
