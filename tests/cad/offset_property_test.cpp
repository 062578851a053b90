// Random solids through the whole main job: what must hold whatever the part, the distance, the
// place and the scale.
#include "phront/cad/offset_shape.h"

#include <gtest/gtest.h>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepClass3d_SolidClassifier.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <gp_Quaternion.hxx>

#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "solids.h"

namespace phront::cad {
namespace {

constexpr double kPi = std::numbers::pi;

/// Steiner's formula: V + A d + M d^2 + 4/3 pi d^3 with the integral M of mean curvature.
struct Convex {
  double volume = 0;
  double area = 0;
  double curvature = 0;
  [[nodiscard]] double grown(double d) const {
    return volume + area * d + curvature * d * d + 4.0 / 3.0 * kPi * d * d * d;
  }
};

struct Sample {
  TopoDS_Shape shape;
  double inradius = 0;
  std::optional<Convex> convex;
};

TopoDS_Shape prism(int sides, double radius, double height) {
  BRepBuilderAPI_MakePolygon polygon;
  for (int i = 0; i < sides; ++i) {
    const double a = 2 * kPi * i / sides;
    polygon.Add(gp_Pnt(radius * std::cos(a), radius * std::sin(a), 0));
  }
  polygon.Close();
  return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(polygon.Wire()).Face(), gp_Vec(0, 0, height))
      .Shape();
}

Sample randomBox(double a, double b, double c) {
  return {test::box(a, b, c), std::min({a, b, c}) / 2,
          Convex{a * b * c, 2 * (a * b + b * c + c * a), kPi * (a + b + c)}};
}

Sample randomCylinder(double r, double h) {
  return {test::cylinder(r, h), std::min(r, h / 2),
          Convex{kPi * r * r * h, 2 * kPi * r * (r + h), kPi * (h + kPi * r)}};
}

Sample randomPrism(int n, double r, double h) {
  const double side = 2 * r * std::sin(kPi / n);
  const double apothem = r * std::cos(kPi / n);
  const double base = n * side * apothem / 2;
  return {prism(n, r, h), std::min(apothem, h / 2),
          Convex{base * h, 2 * base + n * side * h, kPi * h + kPi * n * side / 2}};
}

// L-shape of two legs of the same width, as the union of two boxes.
Sample randomLShape(double width, double height) {
  const TopoDS_Shape one = test::box(width + 1, width, height);
  const TopoDS_Shape other = test::box(width, width + 1, height);
  const TopoDS_Shape both = BRepAlgoAPI_Fuse(one, other).Shape();
  // The largest ball that fits touches the two outer sides and the concave edge.
  const double knee = (2 - std::sqrt(2.0)) * width;
  return {TopExp_Explorer(both, TopAbs_SOLID).Current(), std::min(knee, height / 2), std::nullopt};
}

Sample randomSample(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> size(0.5, 2);
  const double a = size(random);
  const double b = size(random);
  const double c = size(random);
  Sample sample = seed % 4 == 0   ? randomBox(a, b, c)
                  : seed % 4 == 1 ? randomCylinder(a, b)
                  : seed % 4 == 2 ? randomPrism(3 + static_cast<int>(seed) % 5, a, b)
                                  : randomLShape(a, b);
  const double scale = std::pow(10.0, 3 * (static_cast<double>(seed / 4 % 3) - 1));
  gp_Trsf turn;
  turn.SetRotation(gp_Quaternion(gp_Vec(a, b, c), 2 * kPi * size(random)));
  gp_Trsf grow;
  grow.SetScale(gp_Pnt(0, 0, 0), scale);
  sample.shape = test::transformed(test::transformed(sample.shape, turn), grow);
  sample.inradius *= scale;
  if (sample.convex) {
    sample.convex->volume *= scale * scale * scale;
    sample.convex->area *= scale * scale;
    sample.convex->curvature *= scale;
  }
  return sample;
}

OffsetOptions by(double distance) {
  OffsetOptions options;
  options.distance = distance;
  options.threads = 1;
  return options;
}

OffsetResult offsetOf(const TopoDS_Shape& shape, double distance) {
  Model model;
  model.bodies.push_back(test::solidBody(shape));
  auto result = offsetModel(model, by(distance));
  EXPECT_TRUE(result) << (result ? "" : result.error().message);
  EXPECT_TRUE(result->accepted()) << "d = " << distance << ": "
                                  << (result->accepted() ? "" : result->report.check.reasons[0]);
  return std::move(*result);
}

double volumeOf(const OffsetResult& result) {
  double sum = 0;
  for (const Body& body : result.model.bodies) {
    GProp_GProps properties;
    BRepGProp::VolumeProperties(occtShape(body.shape), properties);
    sum += properties.Mass();
  }
  return sum;
}

/// Every vertex of the inner solid lies inside the outer one.
void expectNested(const OffsetResult& inner, const TopoDS_Shape& outer, double tolerance) {
  BRepClass3d_SolidClassifier classifier(outer);
  for (const Body& body : inner.model.bodies) {
    TopTools_IndexedMapOfShape vertices;
    TopExp::MapShapes(occtShape(body.shape), TopAbs_VERTEX, vertices);
    for (int i = 1; i <= vertices.Extent(); ++i) {
      classifier.Perform(BRep_Tool::Pnt(TopoDS::Vertex(vertices(i))), tolerance);
      EXPECT_EQ(classifier.State(), TopAbs_IN);
    }
  }
}

class OffsetProperty : public testing::TestWithParam<unsigned> {};

TEST_P(OffsetProperty, NestsAndObeysSteinerAndIsEmptyBeyondTheInradius) {
  const Sample sample = randomSample(GetParam());
  const double r = sample.inradius;
  SCOPED_TRACE(testing::Message() << "inradius " << r);

  const OffsetResult shrunk = offsetOf(sample.shape, -0.4 * r);
  const OffsetResult grown = offsetOf(sample.shape, 0.5 * r);
  ASSERT_FALSE(shrunk.model.bodies.empty());
  ASSERT_EQ(grown.model.bodies.size(), 1U);
  expectNested(shrunk, sample.shape, 1e-4 * r);
  expectNested(shrunk, occtShape(grown.model.bodies.front().shape), 1e-4 * r);
  GProp_GProps own;
  BRepGProp::VolumeProperties(sample.shape, own);
  EXPECT_LT(volumeOf(shrunk), own.Mass());
  EXPECT_GT(volumeOf(grown), own.Mass());
  if (sample.convex) {
    const double steiner = sample.convex->grown(0.5 * r);
    EXPECT_NEAR(volumeOf(grown), steiner, 1e-4 * steiner);
  }

  const OffsetResult least = offsetOf(sample.shape, -0.95 * r);
  EXPECT_FALSE(least.model.bodies.empty());
  expectNested(least, occtShape(shrunk.model.bodies.front().shape), 1e-4 * r);
  const OffsetResult none = offsetOf(sample.shape, -1.05 * r);
  EXPECT_TRUE(none.model.bodies.empty());
  EXPECT_EQ(none.report.bodies.front().kind, OffsetKind::Empty);
}

INSTANTIATE_TEST_SUITE_P(Solids, OffsetProperty, testing::Range(0U, 12U));

TEST(OffsetOfSeveralBodies, GrowsTogetherWhatComesToMeet) {
  const auto boxAt = [](double x) {
    gp_Trsf shift;
    shift.SetTranslation(gp_Vec(x, 0.3, 0.2));
    return test::solidBody(test::transformed(test::box(2, 2, 2), shift));
  };
  Model model;
  model.bodies = {boxAt(0), boxAt(2.5), boxAt(20)};  // a gap of 0.5, then one of 15.5
  const auto apart = offsetModel(model, by(0.2));
  ASSERT_TRUE(apart) << apart.error().message;
  EXPECT_TRUE(apart->accepted());
  EXPECT_EQ(apart->model.bodies.size(), 3U);

  const auto grown = offsetModel(model, by(1));
  ASSERT_TRUE(grown) << grown.error().message;
  EXPECT_TRUE(grown->accepted());
  EXPECT_EQ(grown->model.bodies.size(), 2U);
  EXPECT_EQ(grown->report.bodies.size(), 2U);
  EXPECT_FALSE(grown->report.warnings.empty());

  const auto shrunk = offsetModel(model, by(-0.5));
  ASSERT_TRUE(shrunk) << shrunk.error().message;
  EXPECT_TRUE(shrunk->accepted());
  EXPECT_EQ(shrunk->model.bodies.size(), 3U);
}

}  // namespace
}  // namespace phront::cad
