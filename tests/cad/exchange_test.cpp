// Files in and out: what is written is read back the same.
#include "phront/cad/exchange.h"

#include <gtest/gtest.h>

#include <unistd.h>
#include <BRepBuilderAPI_Copy.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRep_Builder.hxx>
#include <GProp_GProps.hxx>
#include <Geom_Circle.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <ShapeAnalysis_ShapeTolerance.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gp.hxx>
#include <gp_Ax3.hxx>
#include <sstream>

#include "patches/patch_tools.h"
#include "phront/cad/shape_occt.h"

namespace phront::cad {
namespace {

namespace fs = std::filesystem;

/// Piece of a spindle torus from a circle to its apex. The circle's own parameter passes zero.
TopoDS_Face apexPatch() {
  constexpr double kMajor = 0.5;
  constexpr double kMinor = 1.142715;
  constexpr double kLeft = 2.5;
  constexpr double kRight = 3.7;
  const double apex = std::acos(-kMajor / kMinor);
  const double low = apex - 0.45;
  const Handle(Geom_ToroidalSurface) surface = new Geom_ToroidalSurface(gp_Ax3(), kMajor, kMinor);
  const gp_Ax2 zeroInside(gp_Pnt(0, 0, kMinor * std::sin(low)), gp::DZ(),
                          gp_Dir(std::cos(3.2), std::sin(3.2), 0));
  const TopoDS_Vertex first = makeVertex(surface->Value(kLeft, low), 1e-7);
  const TopoDS_Vertex last = makeVertex(surface->Value(kRight, low), 1e-7);
  const TopoDS_Vertex pole = makeVertex(surface->Value(kLeft, apex), 1e-7);
  const BRep_Builder builder;
  TopoDS_Edge circle;
  builder.MakeEdge(circle, new Geom_Circle(zeroInside, kMajor + kMinor * std::cos(low)), 1e-7);
  builder.Add(circle, first.Oriented(TopAbs_FORWARD));
  builder.Add(circle, last.Oriented(TopAbs_REVERSED));
  builder.Range(circle, kLeft - 3.2, kRight - 3.2);
  ArcPool arcs;
  const auto meridian = [&](const TopoDS_Vertex& from, double u) -> PatchSide {
    const gp_Pnt centre(kMajor * std::cos(u), kMajor * std::sin(u), 0);
    const gp_Vec axis(std::sin(u), -std::cos(u), 0);
    return {arcs.arc(centre, axis, kMinor, from, pole), {u, low}, {u, apex}, false, {}};
  };
  return faceFromSides(surface,
                       {{circle, {kLeft, low}, {kRight, low}, false, {}},
                        meridian(last, kRight),
                        {{}, {kLeft, apex}, {kRight, apex}, true, pole},
                        meridian(first, kLeft)},
                       1e-7);
}

class Exchange : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("phront_exchange_" + std::to_string(::getpid()) + "_" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] fs::path path(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] int filesInFolder() const {
    return static_cast<int>(std::distance(fs::directory_iterator(folder_), {}));
  }

 private:
  fs::path folder_;
};

Body bodyOf(const TopoDS_Shape& shape, const std::string& name,
            std::vector<std::string> faceNames = {}) {
  Body body;
  body.shape = makeShape(shape);
  body.kind = shape.ShapeType() == TopAbs_SOLID ? BodyKind::Solid : BodyKind::Sheet;
  body.name = name;
  body.faceNames = std::move(faceNames);
  return body;
}

double volumeOf(const Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(occtShape(shape), properties);
  return properties.Mass();
}

TopoDS_Shape firstOf(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
  return TopExp_Explorer(shape, kind).Current();
}

gp_Trsf somewhere() {
  gp_Trsf place;
  place.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(1, 1, 0)), 0.8);
  place.SetTranslationPart(gp_Vec(40, -20, 7));
  return place;
}

TEST_F(Exchange, FormatFollowsExtension) {
  EXPECT_EQ(*shapeFormatOf("a.STEP"), ShapeFormat::Step);
  EXPECT_EQ(*shapeFormatOf("a.b.stp"), ShapeFormat::Step);
  EXPECT_EQ(*shapeFormatOf("a.igs"), ShapeFormat::Iges);
  EXPECT_EQ(*shapeFormatOf("a.Iges"), ShapeFormat::Iges);
  EXPECT_EQ(*shapeFormatOf("a.brp"), ShapeFormat::Brep);
  const auto unknown = shapeFormatOf("a.stl");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::InvalidArgument);
  EXPECT_NE(unknown.error().message.find(".step"), std::string::npos);
}

TEST_F(Exchange, SolidsSurviveEveryFormat) {
  Model model;
  model.bodies.push_back(bodyOf(BRepPrimAPI_MakeBox(10, 20, 30).Solid(), "block"));
  model.bodies.push_back(
      bodyOf(BRepPrimAPI_MakeTorus(50, 5).Shape().Moved(TopLoc_Location(somewhere())), "ring"));
  const double box = 6000;
  const double torus = 2 * M_PI * M_PI * 50 * 25;
  for (const char* name : {"a.step", "a.iges", "a.brep"}) {
    ASSERT_TRUE(writeModel(model, path(name))) << name;
    const auto again = readModel(path(name));
    ASSERT_TRUE(again) << again.error().message;
    ASSERT_EQ(again->bodies.size(), 2U) << name;
    // The formats keep about 15 digits.
    EXPECT_NEAR(volumeOf(again->bodies[0].shape), box, 1e-9 * box) << name;
    EXPECT_NEAR(volumeOf(again->bodies[1].shape), torus, 1e-9 * torus) << name;
    EXPECT_EQ(faceCount(again->bodies[0].shape), 6) << name;
    for (const Body& body : again->bodies) {
      EXPECT_EQ(body.kind, BodyKind::Solid) << name;
      EXPECT_TRUE(BRepCheck_Analyzer(occtShape(body.shape)).IsValid()) << name;
      EXPECT_EQ(body.faceNames.size(), static_cast<std::size_t>(faceCount(body.shape)));
    }
    const Box3 place = boundingBox(again->bodies[1].shape);
    const Box3 wanted = boundingBox(model.bodies[1].shape);
    EXPECT_LT((place.center() - wanted.center()).norm(), 1e-5) << name;
    EXPECT_TRUE(again->warnings.empty()) << again->warnings.front();
  }
}

TEST_F(Exchange, NamesSurviveStep) {
  const std::string bodyName = "Geh\xC3\xA4use 'A' \\ 1";
  const std::vector<std::string> faceNames = {"inlet", "", "wall 'b'", "", "", "\xE2\x82\xAC"};
  Model model;
  model.bodies.push_back(bodyOf(BRepPrimAPI_MakeBox(1, 2, 3).Solid(), bodyName, faceNames));
  model.bodies.push_back(bodyOf(BRepPrimAPI_MakeSphere(1).Solid(), "ball"));
  ASSERT_TRUE(writeModel(model, path("named.step")));
  const auto again = readModel(path("named.step"));
  ASSERT_TRUE(again) << again.error().message;
  ASSERT_EQ(again->bodies.size(), 2U);
  EXPECT_EQ(again->bodies[0].name, bodyName);
  EXPECT_EQ(again->bodies[1].name, "ball");
  EXPECT_EQ(again->bodies[0].faceNames, faceNames);
}

TEST_F(Exchange, ColoursSurviveStep) {
  const Colour steel{0.25, 0.5, 0.75};
  const Colour red{1, 0, 0};  // one of those that STEP has a word for
  Model model;
  model.bodies.push_back(bodyOf(BRepPrimAPI_MakeBox(1, 2, 3).Solid(), "box"));
  model.bodies.push_back(bodyOf(BRepPrimAPI_MakeSphere(1).Solid(), "ball"));
  model.bodies.push_back(bodyOf(BRepPrimAPI_MakeBox(4, 5, 6).Solid(), "plain"));
  model.bodies[0].colour = steel;
  model.bodies[0].faceColours = {{}, red, {}, {}, steel, {}};
  model.bodies[1].faceColours = {red};
  ASSERT_TRUE(writeModel(model, path("coloured.step")));
  const auto again = readModel(path("coloured.step"));
  ASSERT_TRUE(again) << again.error().message;
  ASSERT_EQ(again->bodies.size(), 3U);
  const auto near = [](const std::optional<Colour>& a, const std::optional<Colour>& b) {
    if (!a || !b) return !a && !b;
    return std::abs(a->red - b->red) + std::abs(a->green - b->green) + std::abs(a->blue - b->blue) <
           1e-5;
  };
  for (std::size_t b = 0; b < 3; ++b) {
    const Body& was = model.bodies[b];
    const Body& is = again->bodies[b];
    EXPECT_TRUE(near(is.colour, was.colour)) << b;
    ASSERT_EQ(is.faceColours.size(), was.faceColours.size()) << b;
    for (std::size_t f = 0; f < is.faceColours.size(); ++f)
      EXPECT_TRUE(near(is.faceColours[f], was.faceColours[f])) << b << " " << f;
  }
}

/// A machine of two drives, each a motor on a foot, and a cover beside them.
Model machine() {
  const TopoDS_Shape motor = BRepPrimAPI_MakeCylinder(5, 20).Solid();
  const TopoDS_Shape foot = BRepPrimAPI_MakeBox(10, 10, 2).Solid();
  Model model;
  model.assemblies = {{"machine", -1}, {"drive", 0}, {"drive", 0}};
  for (const int drive : {1, 2}) {
    gp_Trsf place = somewhere();
    place.SetTranslationPart(gp_Vec(0, 40.0 * drive, 0));
    model.bodies.push_back(bodyOf(motor.Moved(TopLoc_Location(place)), "motor"));
    model.bodies.push_back(bodyOf(foot.Moved(TopLoc_Location(place)), "foot"));
    model.bodies[model.bodies.size() - 1].assembly = drive;
    model.bodies[model.bodies.size() - 2].assembly = drive;
  }
  model.bodies.push_back(bodyOf(BRepPrimAPI_MakeBox(50, 1, 50).Solid(), "cover"));
  model.bodies.back().assembly = 0;
  const TopLoc_Location away(somewhere());
  model.bodies.push_back(bodyOf(BRepPrimAPI_MakeSphere(3).Shape().Moved(away), "loose"));
  return model;
}

TEST_F(Exchange, AssembliesSurviveStep) {
  Model model = machine();
  const Colour steel{0.25, 0.5, 0.75};
  model.bodies[0].colour = steel;
  model.bodies[5].colour = steel;
  model.bodies[0].faceNames = {"shaft", "", "flange"};
  ASSERT_TRUE(writeModel(model, path("machine.step")));
  const auto again = readModel(path("machine.step"));
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->assemblies, model.assemblies);
  ASSERT_EQ(again->bodies.size(), model.bodies.size());
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const Body& body = again->bodies[b];
    EXPECT_EQ(body.name, model.bodies[b].name);
    EXPECT_EQ(body.assembly, model.bodies[b].assembly);
    const Box3 place = boundingBox(body.shape);
    EXPECT_LT((place.center() - boundingBox(model.bodies[b].shape).center()).norm(), 1e-5);
  }
  for (const std::size_t b : {0, 5}) {
    ASSERT_TRUE(again->bodies[b].colour);
    EXPECT_NEAR(again->bodies[b].colour->green, steel.green, 1e-6);
  }
  EXPECT_EQ(again->bodies[0].faceNames, model.bodies[0].faceNames);
}

TEST_F(Exchange, RefusesAssembliesThatAreNoTree) {
  for (const int parent : {0, 1, 7, -2}) {
    Model model = machine();
    model.assemblies[0].parent = parent;
    EXPECT_EQ(writeModel(model, path("no.step")).error().code, ErrorCode::CannotWrite);
  }
  Model model = machine();
  model.bodies[0].assembly = 3;
  EXPECT_EQ(writeModel(model, path("no.step")).error().code, ErrorCode::CannotWrite);
}

TEST_F(Exchange, SheetsStaySheets) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(1, 2, 3).Shape();
  Model model;
  model.bodies.push_back(bodyOf(firstOf(box, TopAbs_FACE), "flap"));
  for (const char* name : {"a.step", "a.iges", "a.brep"}) {
    ASSERT_TRUE(writeModel(model, path(name))) << name;
    const auto again = readModel(path(name));
    ASSERT_TRUE(again) << again.error().message;
    ASSERT_EQ(again->bodies.size(), 1U);
    EXPECT_EQ(again->bodies[0].kind, BodyKind::Sheet);
    EXPECT_EQ(faceCount(again->bodies[0].shape), 1);
    ASSERT_FALSE(again->warnings.empty());
    EXPECT_NE(again->warnings.back().find("4 free edges"), std::string::npos);
  }
}

TEST_F(Exchange, LooseFacesThatCloseBecomeASolid) {
  // Six faces without common edges, as IGES surface models have them.
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(1, 2, 3).Shape();
  Model model;
  for (TopExp_Explorer it(box, TopAbs_FACE); it.More(); it.Next()) {
    const TopoDS_Shape alone = BRepBuilderAPI_Copy(it.Current()).Shape();
    model.bodies.push_back(bodyOf(alone, ""));
  }
  ASSERT_TRUE(writeModel(model, path("faces.step")));
  const auto again = readModel(path("faces.step"));
  ASSERT_TRUE(again) << again.error().message;
  ASSERT_EQ(again->bodies.size(), 1U);
  EXPECT_EQ(again->bodies[0].kind, BodyKind::Solid);
  EXPECT_NEAR(volumeOf(again->bodies[0].shape), 6, 1e-9);
  const auto asIs = readModel(path("faces.step"), {.repair = false});
  ASSERT_TRUE(asIs);
  EXPECT_EQ(asIs->bodies.size(), 6U);
}

TEST_F(Exchange, FacesOfASheetThatDisagreeAreNamed) {
  // Two faces of a box side by side, the second inside out.
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(1, 2, 3).Shape();
  TopExp_Explorer it(box, TopAbs_FACE);
  const TopoDS_Shape first = BRepBuilderAPI_Copy(it.Current()).Shape();
  it.Next();
  it.Next();
  const TopoDS_Shape second = BRepBuilderAPI_Copy(it.Current()).Shape();
  for (const bool disagree : {false, true}) {
    Model model;
    model.bodies.push_back(bodyOf(first, ""));
    model.bodies.push_back(bodyOf(disagree ? second.Reversed() : second, ""));
    ASSERT_TRUE(writeModel(model, path("sheet.brep")));
    const auto again = readModel(path("sheet.brep"));
    ASSERT_TRUE(again) << again.error().message;
    ASSERT_EQ(again->bodies.size(), 1U);
    const bool named = std::any_of(
        again->warnings.begin(), again->warnings.end(),
        [](const std::string& w) { return w.find("1 face is turned") != std::string::npos; });
    EXPECT_EQ(named, disagree);
  }
}

TEST_F(Exchange, InsideOutSolidIsTurned) {
  Model model;
  model.bodies.push_back(bodyOf(BRepPrimAPI_MakeBox(1, 2, 3).Solid().Reversed(), "box"));
  ASSERT_LT(volumeOf(model.bodies[0].shape), 0);
  ASSERT_TRUE(writeModel(model, path("out.brep")));
  const auto again = readModel(path("out.brep"));
  ASSERT_TRUE(again);
  EXPECT_NEAR(volumeOf(again->bodies[0].shape), 6, 1e-9);
  ASSERT_EQ(again->warnings.size(), 1U);
  EXPECT_NE(again->warnings[0].find("inside out"), std::string::npos);
  const auto asIs = readModel(path("out.brep"), {.repair = false});
  ASSERT_TRUE(asIs);
  EXPECT_LT(volumeOf(asIs->bodies[0].shape), 0);
}

TEST_F(Exchange, UnitOfTheFileIsHonoured) {
  Model box;
  box.bodies.push_back(bodyOf(BRepPrimAPI_MakeBox(1, 2, 3).Solid(), "box"));
  ASSERT_TRUE(writeModel(box, path("mm.step")));
  std::ifstream stream(path("mm.step"));
  std::stringstream text;
  text << stream.rdbuf();
  std::string file = text.str();
  const std::string metric = "LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.)";
  const std::size_t unit = file.find(metric);
  ASSERT_NE(unit, std::string::npos);
  file.replace(unit, metric.size(),
               "CONVERSION_BASED_UNIT('INCH',#9001) LENGTH_UNIT() NAMED_UNIT(#9002)");
  file.insert(file.find("DATA;") + 5,
              "#9001 = LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#9003);"
              "#9002 = DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);"
              "#9003 = ( " +
                  metric + " );");
  std::ofstream(path("inch.step")) << file;
  const auto model = readModel(path("inch.step"));
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->unit, "in");
  EXPECT_NEAR(model->unitInMm, 25.4, 1e-9);
  EXPECT_NEAR(volumeOf(model->bodies[0].shape), 6 * 25.4 * 25.4 * 25.4, 1e-6);
  ASSERT_FALSE(model->warnings.empty());
  EXPECT_NE(model->warnings[0].find("25.4 x 50.8 x 76.2"), std::string::npos) << model->warnings[0];
}

TEST_F(Exchange, WritesWholeFilesOrNone) {
  Model model;
  model.bodies.push_back(bodyOf(BRepPrimAPI_MakeBox(1, 2, 3).Solid(), "box"));
  fs::create_directory(path("folder.step"));
  const auto folder = writeModel(model, path("folder.step"));
  ASSERT_FALSE(folder);
  EXPECT_EQ(folder.error().code, ErrorCode::CannotWrite);
  EXPECT_NE(folder.error().message.find("folder"), std::string::npos);
  const auto nowhere = writeModel(model, path("no/such/a.step"));
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().code, ErrorCode::CannotWrite);
  const auto nothing = writeModel({}, path("a.step"));
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().code, ErrorCode::CannotWrite);
  const auto device = writeModel(model, "/dev/full.step");
  EXPECT_TRUE(!device || fs::remove("/dev/full.step"));
  EXPECT_EQ(writeModel(model, path("a.stl")).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(filesInFolder(), 1);  // the folder made above
  ASSERT_TRUE(writeModel(model, path("a.step")));
  ASSERT_TRUE(writeModel(model, path("a.step")));  // again, over the old one
  EXPECT_EQ(filesInFolder(), 2);
}

TEST_F(Exchange, RefusesNonsenseOptions) {
  EXPECT_EQ(readModel(path("a.step"), {.timeLimit = -1}).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(readModel(path("a.step"), {.maxExtent = NAN}).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(readModel(path("a.step"), {.sewTolerance = 0}).error().code,
            ErrorCode::InvalidArgument);
}

TEST_F(Exchange, LimitsHold) {
  Model model;
  model.bodies.push_back(bodyOf(BRepPrimAPI_MakeBox(1, 2, 3).Solid(), "box"));
  ASSERT_TRUE(writeModel(model, path("a.step")));
  const auto late = readModel(path("a.step"), {.timeLimit = 1e-3});
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, ErrorCode::ResourceLimit);
  EXPECT_EQ(late.error().message, "reading a.step did not finish within 0.001 s");
  const auto large = readModel(path("a.step"), {.maxExtent = 2});
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error().code, ErrorCode::UnreadableInput);
}

double areaOf(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(shape, properties);
  return properties.Mass();
}

// A reader makes the parameters of arcs anew; one that passes zero was taken for its complement.
TEST_F(Exchange, ArcsThatPassZeroComeBackTheSame) {
  const TopoDS_Face face = apexPatch();
  ASSERT_TRUE(BRepCheck_Analyzer(face).IsValid());
  for (const char* name : {"apex.step", "apex.igs"}) {
    Model model;
    model.bodies.push_back(bodyOf(face, "apex"));
    ASSERT_TRUE(writeModel(model, path(name)));
    ReadOptions asWritten;
    asWritten.repair = false;
    const Result<Model> back = readModel(path(name), asWritten);
    ASSERT_TRUE(back) << name;
    const TopoDS_Shape& read = occtShape(back->bodies.front().shape);
    EXPECT_NEAR(areaOf(read), areaOf(face), 1e-4) << name;
    EXPECT_TRUE(BRepCheck_Analyzer(read).IsValid()) << name;
  }
}

// A file may claim a tolerance far above what there is; what really is apart keeps it and is told.
TEST_F(Exchange, OverstatedTolerancesAreLowered) {
  const TopoDS_Shape solid = BRepBuilderAPI_Copy(BRepPrimAPI_MakeCylinder(10, 20).Solid()).Shape();
  for (TopExp_Explorer e(solid, TopAbs_EDGE); e.More(); e.Next())
    BRep_Builder().UpdateEdge(TopoDS::Edge(e.Current()), 1.0);
  const TopoDS_Vertex apart = TopoDS::Vertex(firstOf(solid, TopAbs_VERTEX));
  const double gap = 0.5;
  for (const bool real : {false, true}) {
    const gp_Pnt at = BRep_Tool::Pnt(apart).Translated(gp_Vec(real ? gap : 0, 0, 0));
    BRep_Builder().UpdateVertex(apart, at, 1.0);
    Model model;
    model.bodies.push_back(bodyOf(solid, "pin"));
    ASSERT_TRUE(writeModel(model, path("pin.brep")));
    const Result<Model> back = readModel(path("pin.brep"));
    ASSERT_TRUE(back) << back.error().message;
    const TopoDS_Shape& read = occtShape(back->bodies.front().shape);
    EXPECT_TRUE(BRepCheck_Analyzer(read).IsValid());
    const double largest = ShapeAnalysis_ShapeTolerance().Tolerance(read, 1);
    if (real) {
      EXPECT_GE(largest, gap);
      EXPECT_LT(largest, 1.2 * gap);
    } else {
      EXPECT_LT(largest, 1e-6);
    }
    EXPECT_EQ(back->warnings.size(), real ? 1U : 0U);
  }
}

}  // namespace
}  // namespace phront::cad
