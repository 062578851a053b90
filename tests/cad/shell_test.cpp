// Hollow solids against volumes by formula, and the judge of shells against wrong ones.
#include "phront/cad/shell_shape.h"

#include <gtest/gtest.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <cmath>
#include <filesystem>
#include <gp_Ax2.hxx>
#include <numbers>

#include "phront/cad/exchange.h"
#include "solids.h"

namespace phront::cad {
namespace {

using std::numbers::pi;

Model modelOf(const TopoDS_Shape& shape) {
  Model model;
  model.bodies.push_back(test::solidBody(shape));
  return model;
}

ShellOptions optionsFor(const Model& model, double thickness, const std::string& open,
                        ShellSide side = ShellSide::In) {
  ShellOptions options;
  options.thickness = thickness;
  options.side = side;
  if (!open.empty()) options.open = selectFaces(model, open).value();
  return options;
}

/// The shell, which must pass.
ShellResult shellOf(const Model& model, const ShellOptions& options) {
  Result<ShellResult> made = shellModel(model, options);
  if (!made) {
    ADD_FAILURE() << made.error().message;
    return {};
  }
  for (const std::string& reason : made->report.check.reasons) ADD_FAILURE() << reason;
  EXPECT_LT(made->report.check.accuracyP99, 1e-6);
  return std::move(*made);
}

double volumeOf(const ShellResult& shell) { return shell.report.check.volume; }

TopoDS_Shape block() { return test::box(20, 30, 10); }

/// Plate 40 x 40 x 10 under a round boss of radius 8 and height 15.
TopoDS_Shape plateWithBoss() {
  const TopoDS_Shape plate = BRepPrimAPI_MakeBox(gp_Pnt(-20, -20, -10), 40, 40, 10).Solid();
  const TopoDS_Shape boss = BRepPrimAPI_MakeCylinder(8, 15).Solid();
  return TopExp_Explorer(BRepAlgoAPI_Fuse(plate, boss).Shape(), TopAbs_SOLID).Current();
}

TEST(Shell, ClosedBoxHasACavity) {
  const Model model = modelOf(block());
  const ShellResult shell = shellOf(model, optionsFor(model, 1, ""));
  EXPECT_NEAR(volumeOf(shell), 6000 - 18 * 28 * 8, 1e-6);
  EXPECT_EQ(shell.report.check.shells, 2);
}

TEST(Shell, OpenBoxInwards) {
  const Model model = modelOf(block());
  const ShellResult shell = shellOf(model, optionsFor(model, 1, "normal:+z"));
  EXPECT_NEAR(volumeOf(shell), 6000 - 18 * 28 * 9, 1e-6);
  EXPECT_EQ(shell.report.check.faces, 11);
}

TEST(Shell, OpenBoxOutwardsIsRounded) {
  const Model model = modelOf(block());
  const ShellResult shell = shellOf(model, optionsFor(model, 1, "normal:+z", ShellSide::Out));
  EXPECT_NEAR(volumeOf(shell), 1000 + 600 + 10 * pi + 25 * pi + 2 * pi / 3, 1e-6);
}

TEST(Shell, HalfOnEitherSide) {
  const Model model = modelOf(block());
  const ShellResult shell = shellOf(model, optionsFor(model, 1, "normal:+z", ShellSide::Both));
  const double inner = 6000 - 19 * 29 * 9.5;
  const double outer = 0.5 * 1600 + pi / 4 * 0.25 * 140 + pi / 2 * 4 / 3 * 0.125;
  EXPECT_NEAR(volumeOf(shell), inner + outer, 1e-6);
}

TEST(Shell, OppositeFacesOpenLeaveATube) {
  const Model model = modelOf(block());
  const ShellResult shell = shellOf(model, optionsFor(model, 1, "normal:+z,normal:-z"));
  EXPECT_NEAR(volumeOf(shell), 6000 - 18 * 28 * 10, 1e-6);
}

TEST(Shell, NeighboursOpenLeaveNoWallAtTheirEdge) {
  const Model model = modelOf(block());
  for (const ShellSide side : {ShellSide::In, ShellSide::Out}) {
    const ShellResult shell = shellOf(model, optionsFor(model, 1, "normal:+z,normal:+x", side));
    const double outwards = 20 * 30 + 10 * 30 + 2 * 20 * 10 +          // faces
                            pi / 4 * (2 * 20 + 30 + 2 * 10) + pi / 3;  // edges, two corners
    EXPECT_NEAR(volumeOf(shell), side == ShellSide::In ? 6000 - 19 * 28 * 9 : outwards, 1e-6);
  }
}

TEST(Shell, ThreeFacesOfACornerOpen) {
  const Model model = modelOf(block());
  const ShellResult shell = shellOf(model, optionsFor(model, 1, "normal:+z,normal:+x,normal:+y"));
  EXPECT_NEAR(volumeOf(shell), 6000 - 19 * 29 * 9, 1e-6);
}

TEST(Shell, CylinderOpenAtTheTop) {
  const Model model = modelOf(test::cylinder(10, 20));
  const ShellResult shell = shellOf(model, optionsFor(model, 1, "normal:+z"));
  EXPECT_NEAR(volumeOf(shell), pi * (100 * 20 - 81 * 19), 1e-6);
}

FaceThickness thicknessOf(const Model& model, const std::string& term, double thickness) {
  return {selectFaces(model, term).value().front(), thickness};
}

TEST(Shell, FacesWithAThicknessOfTheirOwnInwards) {
  const Model model = modelOf(block());
  ShellOptions options = optionsFor(model, 1, "normal:+z");
  options.thicknessOf = {thicknessOf(model, "normal:-z", 3), thicknessOf(model, "normal:+x", 0.5)};
  const ShellResult shell = shellOf(model, options);
  EXPECT_NEAR(volumeOf(shell), 6000 - 18.5 * 28 * 7, 1e-6);
  EXPECT_EQ(shell.report.check.faces, 11);
}

TEST(Shell, AThickBottomOutwards) {
  const Model model = modelOf(block());
  ShellOptions options = optionsFor(model, 1, "normal:+z", ShellSide::Out);
  options.thicknessOf = {thicknessOf(model, "normal:-z", 3)};
  EXPECT_NEAR(volumeOf(shellOf(model, options)), 1800 + 1200 + 12 * pi + 25 * pi + 2 * pi / 3,
              1e-6);
}

TEST(Shell, AThickBottomHalfOnEitherSide) {
  const Model model = modelOf(block());
  ShellOptions options = optionsFor(model, 2, "normal:+z", ShellSide::Both);
  options.thicknessOf = {thicknessOf(model, "normal:-z", 4)};
  const double grown = 6600 + 1100 + 600 + 11 * pi + 25 * pi + 2 * pi / 3;
  EXPECT_NEAR(volumeOf(shellOf(model, options)), grown - 18 * 28 * 8, 1e-6);
}

TEST(Shell, AThickWallOfACylinderFarBeyondTheOthers) {
  const Model model = modelOf(BRepPrimAPI_MakeCylinder(10, 20).Solid());
  ShellOptions options = optionsFor(model, 1, "normal:+z");
  options.thicknessOf = {{FaceId{0, 0}, 4}};
  EXPECT_NEAR(volumeOf(shellOf(model, options)), 2000 * pi - 36 * pi * 19, 1e-6);
}

TEST(Shell, TheCheckKnowsWhoseThicknessIsWhose) {
  const Model model = modelOf(block());
  const ShellOptions alike = optionsFor(model, 1, "normal:+z");
  ShellOptions own = alike;
  own.thicknessOf = {thicknessOf(model, "normal:-z", 1.2)};
  const ShellResult plain = shellOf(model, alike);
  const ShellResult thick = shellOf(model, own);
  EXPECT_FALSE(checkShell(model, plain.model, own).value().pass());
  EXPECT_FALSE(checkShell(model, thick.model, alike).value().pass());
  EXPECT_TRUE(checkShell(model, thick.model, own).value().pass());
}

TEST(Shell, RefusesSenselessThicknessesOfFaces) {
  const Model model = modelOf(block());
  ShellOptions options = optionsFor(model, 1, "normal:+z");
  options.thicknessOf = {thicknessOf(model, "normal:-z", 0)};
  EXPECT_EQ(shellModel(model, options).error().code, ErrorCode::InvalidArgument);
  options.thicknessOf = {thicknessOf(model, "normal:+z", 2)};
  EXPECT_EQ(shellModel(model, options).error().code, ErrorCode::InvalidArgument);
  options.thicknessOf = {thicknessOf(model, "normal:-z", 12)};
  EXPECT_EQ(shellModel(model, options).error().code, ErrorCode::NotSupported);
}

TEST(Shell, WallThatRisesFromTheOpeningEndsInABead) {
  const Model model = modelOf(plateWithBoss());
  const auto top = selectFaces(model, "normal:+z");
  ASSERT_TRUE(top);
  ASSERT_EQ(top->size(), 2U);  // the plate's and the boss's
  for (const FaceId face : *top) {
    ShellOptions options = optionsFor(model, 1, "");
    options.open = {face};
    Result<ShellResult> made = shellModel(model, options);
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_TRUE(made->accepted()) << made->report.check.reasons.front();
    // In one case the plate's top is open: a half torus runs round the boss's foot. In the other
    // the boss's: the plate's top is a wall with a round corner to the boss's.
    const double bead = 16000 - 38 * 38 * 9 + 8 * pi * pi + pi * 15 * 15 + pi * 49;
    const double corner = 2 * pi * (8 * pi / 4 - 1.0 / 3);  // quarter disc about r = 8, inwards
    const double wall = 16000 - 38 * 38 * 8 - pi * 64 + corner + pi * 15 * 15;
    const double volume = volumeOf(*made);
    EXPECT_LT(std::min(std::abs(volume - bead), std::abs(volume - wall)), 2e-4 * bead) << volume;
  }
}

TEST(Shell, TooThinToBeHollowStaysAsItIs) {
  const Model model = modelOf(block());
  const ShellResult shell = shellOf(model, optionsFor(model, 6, ""));
  EXPECT_NEAR(volumeOf(shell), 6000, 1e-6);
  EXPECT_EQ(shell.report.warnings.size(), 1U);
}

TEST(Shell, TooThinToBeHollowStillGrows) {
  const Model model = modelOf(block());
  const ShellResult shell = shellOf(model, optionsFor(model, 12, "", ShellSide::Both));
  // Steiner: volume, area, edges, ball.
  const double edges = 4.0 * (20 + 30 + 10);
  EXPECT_NEAR(volumeOf(shell), 6000 + 2200 * 6 + edges * pi / 4 * 36 + 4 * pi / 3 * 216, 1e-5);
}

TEST(Shell, AHoleLeftOpen) {
  const TopoDS_Shape hole = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(20, 20, 0), gp::DZ()), 8, 20);
  const TopoDS_Shape cut = BRepAlgoAPI_Cut(test::box(40, 40, 20), hole).Shape();
  const Model model = modelOf(TopExp_Explorer(cut, TopAbs_SOLID).Current());
  ShellOptions options = optionsFor(model, 1, "");
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(cut, TopAbs_FACE, faces);
  for (int f = 0; f < faces.Extent(); ++f)
    if (BRepAdaptor_Surface(TopoDS::Face(faces(f + 1))).GetType() == GeomAbs_Cylinder)
      options.open = {{0, f}};
  EXPECT_NEAR(volumeOf(shellOf(model, options)), (1600 - 64 * pi) * 20 - (38 * 38 - 64 * pi) * 18,
              1e-5);
}

TEST(Shell, ACapOpenAtItsSphereAndAThickPlateOfIt) {
  const TopoDS_Shape below = BRepPrimAPI_MakeBox(gp_Pnt(-20, -20, -20), gp_Pnt(20, 20, 2));
  const TopoDS_Shape cut = BRepAlgoAPI_Cut(test::sphere(10), below).Shape();
  const Model model = modelOf(TopExp_Explorer(cut, TopAbs_SOLID).Current());
  const auto segment = [](double low, double high) {
    return pi * (100 * (high - low) - (high * high * high - low * low * low) / 3);
  };
  ShellOptions options = optionsFor(model, 1, "area:max");
  EXPECT_NEAR(volumeOf(shellOf(model, options)), segment(2, 3), 1e-5);
  options.thicknessOf = {thicknessOf(model, "normal:-z", 3)};
  EXPECT_NEAR(volumeOf(shellOf(model, options)), segment(2, 5), 1e-5);
}

TEST(Shell, RefusalsNameTheFace) {
  const Model round = modelOf(test::cylinder(10, 20));
  Result<ShellResult> made = shellModel(round, optionsFor(round, 1, "area:max", ShellSide::Out));
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::NotSupported);
  EXPECT_NE(made.error().message.find("not planar"), std::string::npos);

  const Model boss = modelOf(plateWithBoss());
  made = shellModel(boss, optionsFor(boss, 1, "normal:+z", ShellSide::Out));
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::NotSupported);

  EXPECT_EQ(shellModel(round, optionsFor(round, 0, "")).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(shellModel(round, optionsFor(round, NAN, "")).error().code, ErrorCode::InvalidArgument);
}

TEST(Shell, SurvivesAFile) {
  const Model model = modelOf(block());
  ShellResult shell = shellOf(model, optionsFor(model, 1, "normal:+z"));
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "phront_shell.step";
  const Result<std::filesystem::path> written = writeShell(model, shell, path, false);
  ASSERT_TRUE(written);
  EXPECT_EQ(*written, path);
  const Result<Model> back = readModel(path);
  std::filesystem::remove(path);
  ASSERT_TRUE(back);
  const auto check = checkShell(model, *back, shell.report.options);
  ASSERT_TRUE(check);
  EXPECT_TRUE(check->pass());
}

class ShellCheck : public ::testing::Test {
 protected:
  [[nodiscard]] bool passes(const Model& out, double thickness,
                            ShellSide side = ShellSide::In) const {
    const auto check = checkShell(model_, out, optionsFor(model_, thickness, "normal:+z", side));
    EXPECT_TRUE(check) << check.error().message;
    return check && check->pass();
  }
  /// The block without a pocket from (x, y, z) to its top, as deep in x and y.
  static Model pocketed(double x, double y, double z, double height = 20) {
    const TopoDS_Shape tool =
        BRepPrimAPI_MakeBox(gp_Pnt(x, y, z), 20 - 2 * x, 30 - 2 * y, height).Solid();
    return modelOf(TopExp_Explorer(BRepAlgoAPI_Cut(block(), tool).Shape(), TopAbs_SOLID).Current());
  }

  const Model model_ = modelOf(block());
};

TEST_F(ShellCheck, AcceptsThePocket) { EXPECT_TRUE(passes(pocketed(1, 1, 1), 1)); }

TEST_F(ShellCheck, RefusesOtherThickness) {
  EXPECT_FALSE(passes(pocketed(1, 1, 1), 1.02));
  EXPECT_FALSE(passes(pocketed(1, 1.02, 1), 1));
}

TEST_F(ShellCheck, RefusesTheSolidItself) { EXPECT_FALSE(passes(model_, 1)); }

TEST_F(ShellCheck, RefusesAClosedLid) { EXPECT_FALSE(passes(pocketed(1, 1, 1, 8.5), 1)); }

TEST_F(ShellCheck, RefusesAMissingBottom) { EXPECT_FALSE(passes(pocketed(1, 1, -1), 1)); }

TEST_F(ShellCheck, RefusesTheOtherSide) {
  EXPECT_FALSE(passes(pocketed(1, 1, 1), 1, ShellSide::Out));
  EXPECT_FALSE(passes(pocketed(1, 1, 1), 2, ShellSide::Both));
}

TEST(SelectFaces, ByNumberNameNormalAndArea) {
  Model model = modelOf(block());
  model.bodies.push_back(test::solidBody(test::cylinder(1, 2)));
  model.bodies[1].faceNames = {"skin", "lid top", "lid bottom"};
  const auto count = [&](const std::string& terms) {
    const auto found = selectFaces(model, terms);
    return found ? static_cast<int>(found->size()) : -1;
  };
  EXPECT_EQ(count("F1"), 1);
  EXPECT_EQ(count("F9"), 1);
  EXPECT_EQ(selectFaces(model, "F9").value().front(), (FaceId{1, 2}));
  EXPECT_EQ(count("F10"), -1);
  EXPECT_EQ(count("F0"), -1);
  EXPECT_EQ(count("F1,F1,F2"), 2);
  EXPECT_EQ(count("name:lid*"), 2);
  EXPECT_EQ(count("name:*bottom"), 1);
  EXPECT_EQ(count("name:lid"), -1);
  EXPECT_EQ(count("normal:+z"), 2);
  EXPECT_EQ(count("normal:-x"), 1);
  EXPECT_EQ(count("normal:z"), -1);
  EXPECT_EQ(count("area:max"), 2 - 1);
  EXPECT_EQ(count(""), -1);
  EXPECT_EQ(count("F1,"), -1);
  EXPECT_EQ(count("F1x"), -1);
}

}  // namespace
}  // namespace phront::cad
