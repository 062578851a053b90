#include "phront/cad/move_faces.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeWedge.hxx>
#include <GProp_GProps.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <cmath>
#include <gp_Ax1.hxx>
#include <gp_Ax2.hxx>
#include <gp_Trsf.hxx>
#include <numbers>

#include <gtest/gtest.h>

#include "solids.h"

namespace phront::cad {
namespace {

using namespace test;
using std::numbers::pi;

double volumeOf(const Model& model) {
  double volume = 0;
  for (const Body& body : model.bodies) {
    GProp_GProps properties;
    BRepGProp::VolumeProperties(occtShape(body.shape), properties);
    volume += properties.Mass();
  }
  return volume;
}

Model modelOf(const TopoDS_Shape& shape) {
  Model model;
  model.bodies = {solidBody(shape)};
  return model;
}

FaceId faceOf(const Model& model, const std::string& term) {
  const Result<std::vector<FaceId>> faces = selectFaces(model, term);
  EXPECT_TRUE(faces && faces->size() == 1) << term;
  return faces && !faces->empty() ? faces->front() : FaceId{};
}

/// The volume after the moves; 0 when they fail.
double volumeAfter(const Model& model, const std::vector<FaceMove>& moves, int faces) {
  const Result<MovedModel> moved = moveFaces(model, moves);
  EXPECT_TRUE(moved.has_value()) << moved.error().message;
  if (!moved) return 0;
  EXPECT_TRUE(BRepCheck_Analyzer(occtShape(moved->model.bodies[0].shape)).IsValid());
  EXPECT_EQ(faceCount(moved->model.bodies[0].shape), faces);
  EXPECT_EQ(moved->origins[0].size(), static_cast<std::size_t>(faces));
  return volumeOf(moved->model);
}

std::string refusal(const Model& model, const std::vector<FaceMove>& moves) {
  const Result<MovedModel> moved = moveFaces(model, moves);
  return moved ? std::string() : moved.error().message;
}

int faceOfKind(const TopoDS_Shape& shape, GeomAbs_SurfaceType type) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  for (int f = 1; f <= faces.Extent(); ++f)
    if (BRepAdaptor_Surface(TopoDS::Face(faces(f))).GetType() == type) return f - 1;
  return -1;
}

TEST(MoveFaces, OneFaceOfABoxBothWays) {
  const Model model = modelOf(box(10, 20, 30));
  const FaceId top = faceOf(model, "normal:+z");
  EXPECT_NEAR(volumeAfter(model, {{top, 3}}, 6), 10 * 20 * 33, 1e-6);
  EXPECT_NEAR(volumeAfter(model, {{top, -3}}, 6), 10 * 20 * 27, 1e-6);
}

TEST(MoveFaces, NeighboursEachByItsOwnDistance) {
  const Model model = modelOf(box(10, 20, 30));
  const std::vector<FaceMove> moves{{faceOf(model, "normal:+z"), 3},
                                    {faceOf(model, "normal:+x"), 2},
                                    {faceOf(model, "normal:-y"), -4}};
  EXPECT_NEAR(volumeAfter(model, moves, 6), 12 * 16 * 33, 1e-6);
}

gp_Trsf shift(double x, double y, double z) {
  gp_Trsf trsf;
  trsf.SetTranslation(gp_Vec(x, y, z));
  return trsf;
}

// Turned, so that no plane's frame is that of space.
TEST(MoveFaces, FacesBesideAReentrantCorner) {
  const TopoDS_Shape straight = lShape();
  gp_Trsf turn;
  turn.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(1, 2, -1)), 0.7);
  const FaceId top = faceOf(modelOf(straight), "normal:+z");
  const Model model = modelOf(transformed(straight, turn));
  EXPECT_NEAR(volumeAfter(model, {{top, 0.2}}, 8), 3 * 1.2, 1e-9);
  EXPECT_NEAR(volumeAfter(model, {{top, -0.2}}, 8), 3 * 0.8, 1e-9);
}

// A square frustum, 20 wide below, 10 above, 15 high.
TEST(MoveFaces, NeighboursThatLeanStayOnTheirPlanes) {
  const Model model = modelOf(BRepPrimAPI_MakeWedge(20, 15, 20, 5, 5, 15, 15).Solid());
  const auto volume = [](double low, double high) {
    return 4000 * (std::pow(1 - low / 30, 3) - std::pow(1 - high / 30, 3));
  };
  const FaceId top = faceOf(model, "normal:+y");
  const FaceId bottom = faceOf(model, "normal:-y");
  EXPECT_NEAR(volumeAfter(model, {{top, 3}}, 6), volume(0, 18), 1e-6);
  EXPECT_NEAR(volumeAfter(model, {{top, -3}}, 6), volume(0, 12), 1e-6);
  EXPECT_NEAR(volumeAfter(model, {{bottom, 3}}, 6), volume(-3, 15), 1e-6);
  EXPECT_NEAR(volumeAfter(model, {{bottom, -3}}, 6), volume(3, 15), 1e-6);
}

TEST(MoveFaces, AHoleGetsWiderOrNarrower) {
  const TopoDS_Shape hole = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(10, 10, 0), gp::DZ()), 4, 10);
  const TopoDS_Shape plate = BRepAlgoAPI_Cut(box(20, 20, 10), hole);
  const Model model = modelOf(plate);
  const FaceId wall{0, faceOfKind(plate, GeomAbs_Cylinder)};
  EXPECT_NEAR(volumeAfter(model, {{wall, 1}}, 7), 4000 - pi * 9 * 10, 1e-6);
  EXPECT_NEAR(volumeAfter(model, {{wall, -1}}, 7), 4000 - pi * 25 * 10, 1e-6);
  EXPECT_NE(refusal(model, {{wall, 4.5}}), "");
}

/// The volume gained by moving either face that looks up by 2 and by -2 is twice its area.
void expectPrisms(const TopoDS_Shape& part, int faces) {
  const Model model = modelOf(part);
  const Result<std::vector<FaceId>> up = selectFaces(model, "normal:+z");
  ASSERT_TRUE(up && up->size() == 2);
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(occtShape(model.bodies[0].shape), TopAbs_FACE, map);
  for (const FaceId& id : *up) {
    GProp_GProps area;
    BRepGProp::SurfaceProperties(map(id.face + 1), area);
    EXPECT_NEAR(volumeAfter(model, {{id, 2}}, faces), volumeOf(model) + 2 * area.Mass(), 1e-6);
    EXPECT_NEAR(volumeAfter(model, {{id, -2}}, faces), volumeOf(model) - 2 * area.Mass(), 1e-6);
  }
}

TEST(MoveFaces, TheFloorOfAPocketAndThePlateRoundIt) {
  expectPrisms(BRepAlgoAPI_Cut(box(20, 20, 10), transformed(box(7, 10, 4), shift(5, 5, 6))), 11);
}

TEST(MoveFaces, TheTopOfABossAndThePlateRoundIt) {
  expectPrisms(BRepAlgoAPI_Fuse(box(20, 20, 10), transformed(cylinder(4, 5), shift(10, 10, 10))),
               8);
}

TEST(MoveFaces, SmoothNeighboursGoTogether) {
  const TopoDS_Shape block = box(20, 20, 10);
  BRepFilletAPI_MakeFillet fillet(block);
  for (TopExp_Explorer e(block, TopAbs_EDGE); e.More(); e.Next()) {
    const BRepAdaptor_Curve curve(TopoDS::Edge(e.Current()));
    if (std::abs(curve.Line().Direction().Z()) > 0.5) fillet.Add(3, TopoDS::Edge(e.Current()));
  }
  const Model model = modelOf(fillet.Shape());
  const FaceId side = faceOf(model, "normal:+x");
  EXPECT_NE(refusal(model, {{side, 1}}).find("goes on smoothly into F"), std::string::npos);
  std::vector<FaceMove> sides;
  const Result<std::vector<FaceId>> ends = selectFaces(model, "normal:+z,normal:-z");
  ASSERT_TRUE(ends && ends->size() == 2);
  for (int f = 0; f < 10; ++f)
    if (f != (*ends)[0].face && f != (*ends)[1].face) sides.push_back({{0, f}, 1});
  const double area = 400 - (4 - pi) * 9;
  const double outline = 4 * 14 + 6 * pi;
  EXPECT_NEAR(volumeAfter(model, sides, 10), (area + outline + pi) * 10, 1e-6);
  for (FaceMove& move : sides) move.distance = -1;
  EXPECT_NEAR(volumeAfter(model, sides, 10), (area - outline + pi) * 10, 1e-6);
}

TEST(MoveFaces, APlaneCutsTheFilletsRoundIt) {
  const Model model = modelOf(filletedBox(20, 3));
  const FaceId top = faceOf(model, "normal:+z");
  // Above the height 3 - h over the fillets' feet the section is a square with rounded corners.
  const auto volumeAbove = [](double depth) {
    constexpr int kSlices = 20000;
    double volume = 0;
    for (int i = 0; i < kSlices; ++i) {
      const double z = 3 - depth * (i + 0.5) / kSlices;
      const double radius = std::sqrt(9 - z * z);
      volume += (14 * 14 + 4 * 14 * radius + pi * radius * radius) * depth / kSlices;
    }
    return volume;
  };
  EXPECT_NEAR(volumeAfter(model, {{top, -1}}, 26), volumeOf(model) - volumeAbove(1), 1e-3);
  EXPECT_NE(refusal(model, {{top, 1}}), "");
}

TEST(MoveFaces, AVoidStaysWhereItIs) {
  const Model model =
      modelOf(BRepAlgoAPI_Cut(box(20, 20, 20), transformed(box(6, 6, 6), shift(7, 7, 7))));
  const Result<std::vector<FaceId>> up = selectFaces(model, "normal:+z");
  ASSERT_TRUE(up && up->size() == 2);
  for (const FaceId& face : *up) {
    const double more = volumeAfter(model, {{face, 2}}, 12) - volumeOf(model);
    EXPECT_LT(std::min(std::abs(more - 2 * 400), std::abs(more - 2 * 36)), 1e-6);
  }
}

TEST(MoveFaces, RefusesWhatCannotBe) {
  const Model model = modelOf(box(10, 20, 30));
  const FaceId top = faceOf(model, "normal:+z");
  EXPECT_NE(refusal(model, {{top, -30}}), "");
  EXPECT_NE(refusal(model, {{top, -40}}), "");
  EXPECT_NE(refusal(model, {{{0, 6}, 1}}), "");
  EXPECT_NE(refusal(model, {{top, 1}, {top, 2}}), "");
  EXPECT_NE(refusal(model, {{top, std::nan("")}}), "");
}

TEST(MoveFaces, NamesStayWithTheirFaces) {
  Model model = modelOf(box(10, 20, 30));
  const FaceId top = faceOf(model, "normal:+z");
  model.bodies[0].faceNames.assign(6, "");
  model.bodies[0].faceNames[static_cast<std::size_t>(top.face)] = "lid";
  const Result<MovedModel> moved = moveFaces(model, {{top, 3}});
  ASSERT_TRUE(moved.has_value()) << moved.error().message;
  EXPECT_EQ(faceOf(moved->model, "name:lid"), faceOf(moved->model, "normal:+z"));
}

}  // namespace
}  // namespace phront::cad
