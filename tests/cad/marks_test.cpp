// Names and colours travel to the faces that stem from them.
#include <gtest/gtest.h>

#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <map>

#include "phront/cad/offset_shape.h"
#include "phront/cad/shell_shape.h"
#include "solids.h"

namespace phront::cad {
namespace {

constexpr Colour kSteel{0.2, 0.3, 0.4};
constexpr Colour kRed{1, 0, 0};

gp_Pnt centreOf(const TopoDS_Shape& face) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(face, properties);
  return properties.CentreOfMass();
}

/// Faces named by their place, the top and its neighbour at x = 20 red.
Model markedBox() {
  Model model;
  model.bodies.push_back(test::solidBody(test::box(20, 30, 10)));
  Body& body = model.bodies.front();
  body.colour = kSteel;
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(occtShape(body.shape), TopAbs_FACE, faces);
  for (int f = 1; f <= 6; ++f) {
    const gp_Pnt c = centreOf(faces(f));
    const bool top = c.Z() > 9;
    const bool right = c.X() > 19;
    body.faceNames.push_back(top ? "top" : right ? "right" : c.Z() < 1 ? "bottom" : "");
    body.faceColours.push_back(top || right ? std::optional<Colour>(kRed) : std::nullopt);
  }
  return model;
}

/// How often each name occurs, and the centre of its last face.
std::map<std::string, std::pair<int, gp_Pnt>> namesOf(const Body& body) {
  std::map<std::string, std::pair<int, gp_Pnt>> names;
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(occtShape(body.shape), TopAbs_FACE, faces);
  EXPECT_EQ(body.faceNames.size(), static_cast<std::size_t>(faces.Extent()));
  for (std::size_t f = 0; f < body.faceNames.size(); ++f) {
    auto& [count, centre] = names[body.faceNames[f]];
    ++count;
    centre = centreOf(faces(static_cast<int>(f) + 1));
  }
  return names;
}

TEST(Marks, ResultsHangWhereTheirPartsDo) {
  Model model;
  model.assemblies = {{"machine", -1}, {"drive", 0}};
  for (const int assembly : {1, 0, -1}) {
    model.bodies.push_back(test::solidBody(test::transformed(test::box(20, 30, 10), [&] {
      gp_Trsf shift;
      shift.SetTranslation(gp_Vec(100.0 * assembly, 0, 0));
      return shift;
    }())));
    model.bodies.back().assembly = assembly;
  }
  const Result<OffsetResult> grown = offsetModel(model, {.distance = 1});
  const Result<ShellResult> hollow = shellModel(model, {.thickness = 1});
  ASSERT_TRUE(grown && hollow);
  for (const Model* made : {&grown->model, &hollow->model}) {
    EXPECT_EQ(made->assemblies, model.assemblies);
    ASSERT_EQ(made->bodies.size(), 3U);
    for (std::size_t b = 0; b < 3; ++b)
      EXPECT_EQ(made->bodies[b].assembly, model.bodies[b].assembly);
  }
  // Nearer than 2 d the bodies grow together, and the result is in no drive.
  const Result<OffsetResult> one = offsetModel(model, {.distance = 45});
  ASSERT_TRUE(one.has_value());
  ASSERT_EQ(one->model.bodies.size(), 1U);
  EXPECT_EQ(one->model.bodies[0].assembly, -1);
}

TEST(Marks, TravelToTheOffset) {
  const Model model = markedBox();
  for (const double distance : {1.0, -1.0}) {
    const auto offset = offsetModel(model, {.distance = distance});
    ASSERT_TRUE(offset);
    ASSERT_EQ(offset->model.bodies.size(), 1U);
    const Body& body = offset->model.bodies.front();
    EXPECT_EQ(body.colour, kSteel);
    auto names = namesOf(body);
    EXPECT_EQ(names["top"].first, 1);
    EXPECT_NEAR(names["top"].second.Z(), 10 + distance, 1e-9);
    EXPECT_EQ(names["right"].first, 1);
    EXPECT_NEAR(names["right"].second.X(), 20 + distance, 1e-9);
    EXPECT_EQ(names["bottom"].first, 1);
    // Outwards: three more planes, twelve edges, eight corners.
    EXPECT_EQ(names[""].first, distance > 0 ? 23 : 3);
    // The two red faces and the rounding between them.
    EXPECT_EQ(std::count(body.faceColours.begin(), body.faceColours.end(), kRed),
              distance > 0 ? 3 : 2);
  }
}

TEST(Marks, TravelToBothSidesOfAWall) {
  const Model model = markedBox();
  ShellOptions options;
  options.thickness = 1;
  options.open = selectFaces(model, "name:top").value();
  const auto shell = shellModel(model, options);
  ASSERT_TRUE(shell);
  auto names = namesOf(shell->model.bodies.front());
  EXPECT_EQ(names["top"].first, 1);  // the rim
  EXPECT_EQ(names["right"].first, 2);
  EXPECT_EQ(names["bottom"].first, 2);
}

TEST(Marks, OfBodiesThatGrowTogether) {
  Model model = markedBox();
  gp_Trsf aside;
  aside.SetTranslation(gp_Vec(21, 0, 0));
  model.bodies.push_back(test::solidBody(test::transformed(test::box(20, 30, 10), aside)));
  model.bodies[1].faceNames.assign(6, "second");
  const auto offset = offsetModel(model, {.distance = 1});
  ASSERT_TRUE(offset);
  ASSERT_EQ(offset->model.bodies.size(), 1U);
  auto names = namesOf(offset->model.bodies.front());
  EXPECT_GE(names["top"].first, 1);
  EXPECT_GE(names["second"].first, 5);
}

}  // namespace
}  // namespace phront::cad
