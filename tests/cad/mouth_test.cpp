// Holes drilled through curved walls and narrower than the distance: the offset closes over them,
// where the pipes round their rims meet in a ridge.
#include <gtest/gtest.h>
#include <BRepAdaptor_Curve.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRep_Tool.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <cmath>
#include <gp_Elips.hxx>
#include <numbers>
#include <ostream>

#include "heal/heal.h"
#include "patches/bends.h"
#include "patches/patch_tools.h"
#include "patches/raw_complex.h"
#include "patches/rims.h"
#include "phront/cad/tessellate.h"
#include "rebuild/exact_offset.h"
#include "rebuild/select.h"
#include "solids.h"

namespace phront::cad {
namespace {

constexpr double kSmoothAngle = 0.01;

TopoDS_Shape solidIn(const TopoDS_Shape& shape) {
  return TopExp_Explorer(shape, TopAbs_SOLID).Current();
}

/// A hole of radius 1 along `along` through `through`; its seam is turned by `turn` (degrees).
TopoDS_Shape drilled(const TopoDS_Shape& shape, const gp_Pnt& through, const gp_Dir& along,
                     double turn) {
  const gp_Pnt start = through.Translated(gp_Vec(along) * -20);
  gp_Ax2 axis(start, along);
  axis.SetXDirection(gp::DZ());
  axis.Rotate(gp_Ax1(start, along), turn * std::numbers::pi / 180);
  return solidIn(BRepAlgoAPI_Cut(shape, BRepPrimAPI_MakeCylinder(axis, 1, 40).Shape()).Shape());
}

TopoDS_Shape rod() { return test::cylinder(10, 30); }
TopoDS_Shape tube() { return solidIn(BRepAlgoAPI_Cut(rod(), test::cylinder(7, 30)).Shape()); }
TopoDS_Shape taper() { return BRepPrimAPI_MakeCone(10, 5, 30).Solid(); }

const gp_Pnt kMiddle(0, 0, 15);

struct Drilled {
  const char* name;
  TopoDS_Shape shape;
};

void PrintTo(const Drilled& part, std::ostream* out) { *out << part.name; }

class Mouth : public ::testing::TestWithParam<Drilled> {};

TEST_P(Mouth, ClosesOverTheHoleExactly) {
  const TopoDS_Shape& shape = GetParam().shape;
  const double diagonal = diagonalOf(shape);
  for (const double distance : {1.5, 2.0}) {
    const Body body = test::solidBody(shape);
    auto mesh = tessellate(body, {.deflection = 0.02 * distance});
    ASSERT_TRUE(mesh) << mesh.error().message;
    const auto phi = TrueDistance::build(shape, std::move(*mesh));
    ASSERT_TRUE(phi) << phi.error().message;

    const RawComplex raw = buildRawComplex(
        heal(shape, {.tolerance = 1e-5 * diagonal}).shape,
        {.distance = distance, .smoothAngle = kSmoothAngle, .tolerance = 1e-6 * diagonal});
    EXPECT_EQ(raw.missing, 0);
    for (const TopoDS_Face& face : raw.faces)
      for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next())
        EXPECT_LT(BRep_Tool::Tolerance(TopoDS::Edge(e.Current())), 1e-3 * distance);

    const Result<AttemptResult> result =
        tryExactOffset(shape, true, distance, *phi, attemptSettings().front());
    ASSERT_TRUE(result) << distance << ": " << result.error().message;
    EXPECT_TRUE(BRepCheck_Analyzer(result->shape).IsValid());
    EXPECT_EQ(result->fittedFaces, 0);
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(result->shape, TopAbs_FACE, faces);
    for (int f = 1; f <= faces.Extent(); ++f)
      for (const FaceSample& s : interiorSamples(TopoDS::Face(faces(f))))
        EXPECT_NEAR(phi->signedDistance(Vec3(s.point.X(), s.point.Y(), s.point.Z())), distance,
                    1e-4 * distance);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Walls, Mouth,
    ::testing::Values(Drilled{"seam along the rod", drilled(rod(), kMiddle, gp::DX(), 0)},
                      Drilled{"seam across it", drilled(rod(), kMiddle, gp::DX(), 90)},
                      Drilled{"seam anywhere", drilled(rod(), kMiddle, gp::DX(), 30)},
                      Drilled{"tube", drilled(tube(), kMiddle, gp::DX(), 0)},
                      Drilled{"tube, seam anywhere", drilled(tube(), kMiddle, gp::DX(), 30)},
                      Drilled{"off the axis", drilled(rod(), gp_Pnt(0, 4, 15), gp::DX(), 0)},
                      Drilled{"off the axis, seam anywhere",
                              drilled(rod(), gp_Pnt(0, 4, 15), gp::DX(), 30)},
                      Drilled{"oblique", drilled(rod(), kMiddle, gp_Dir(1, 0, 0.6), 0)},
                      Drilled{"cone", drilled(taper(), kMiddle, gp::DX(), 0)}),
    [](const auto& tested) {
      std::string name = tested.param.name;
      name.erase(std::remove_if(name.begin(), name.end(),
                                [](unsigned char c) { return std::isalnum(c) == 0; }),
                 name.end());
      return name;
    });

gp_Pnt pointOf(const TopoDS_Vertex& vertex) { return BRep_Tool::Pnt(vertex); }

// Outside the rod the rim is nearest along it, so that the ridge runs across; inside the tube it is
// the other way round.
TEST(DivideRims, TipsLieWhereTheRidgeEnds) {
  constexpr double kClose = 0.02;
  for (const double turn : {0.0, 30.0, 90.0}) {
    const TopoDS_Shape shape =
        heal(drilled(tube(), kMiddle, gp::DX(), turn), {.tolerance = 1e-4}).shape;
    const DividedRims divided = divideRims(shape, 2, kSmoothAngle);
    ASSERT_EQ(divided.tips.size(), 4U) << turn;
    EXPECT_TRUE(BRepCheck_Analyzer(divided.shape).IsValid());
    for (const RimTips& tips : divided.tips) {
      const gp_Pnt one = pointOf(tips.one);
      const gp_Pnt other = pointOf(tips.other);
      const bool outside = std::hypot(one.X(), one.Y()) > 8.5;
      EXPECT_NEAR(std::abs(one.Y()), outside ? 1 : 0, kClose);
      EXPECT_NEAR(std::abs(one.Z() - 15), outside ? 0 : 1, kClose);
      EXPECT_NEAR(one.Y(), -other.Y(), kClose);
      EXPECT_NEAR(one.Z() - 15, 15 - other.Z(), kClose);
      const auto table = makeEdgeTable(divided.shape, 1, kSmoothAngle);
      EXPECT_TRUE(rimHalves(table, tips));
    }
    const DividedRims without = divideRims(shape, 2, kSmoothAngle, {1});
    EXPECT_EQ(without.tips.size(), 3U);
    for (const RimTips& tips : without.tips) EXPECT_NE(tips.rim, 1U);
  }
}

TEST(DivideRims, LeavesWideHolesAndCirclesAlone) {
  const TopoDS_Shape inRod = heal(drilled(rod(), kMiddle, gp::DX(), 90), {.tolerance = 1e-4}).shape;
  EXPECT_TRUE(divideRims(inRod, 0.9, kSmoothAngle).tips.empty());
  EXPECT_TRUE(divideRims(inRod, -2, kSmoothAngle).tips.empty());
  EXPECT_TRUE(divideRims(inRod, 0.9, kSmoothAngle).shape.IsSame(inRod));
  const TopoDS_Shape inPlate =
      heal(drilled(test::box(9, 9, 9), gp_Pnt(4, 4, 4), gp::DX(), 0), {.tolerance = 1e-4}).shape;
  EXPECT_TRUE(divideRims(inPlate, 2, kSmoothAngle).tips.empty());
}

/// A plate with an oblique hole; the seam of the hole runs along the short axes of its rims.
TopoDS_Shape obliquelyDrilled() {
  constexpr double kTilt = std::numbers::pi / 3;
  const gp_Dir along(std::sin(kTilt), 0, std::cos(kTilt));
  const gp_Pnt start = gp_Pnt(15, 15, 3).Translated(gp_Vec(along) * -30);
  const TopoDS_Shape drill =
      BRepPrimAPI_MakeCylinder(gp_Ax2(start, along, gp::DY()), 1, 60).Shape();
  return solidIn(BRepAlgoAPI_Cut(test::box(30, 30, 6), drill).Shape());
}

// Half axes 2 and 1: the curvature is 2 at the ends of the long one, 1/4 at those of the short one.
// At one of the two ends the wall leans back, and no direction between the normals is near to the
// centre's.
TEST(TightBends, LieAtTheLongAxisOfAnEllipse) {
  const TopoDS_Shape shape = heal(obliquelyDrilled(), {.tolerance = 1e-5}).shape;
  const EdgeTable table = makeEdgeTable(shape, 1, kSmoothAngle);
  int found = 0;
  for (const EdgeInfo& info : table.edges) {
    EXPECT_TRUE(tightBends(info, 0.4).empty());  // does not fold
    for (const double share : tightBends(info, 1)) {
      ++found;
      const BRepAdaptor_Curve curve(info.edge);
      ASSERT_EQ(curve.GetType(), GeomAbs_Ellipse);
      const gp_Pnt p = curve.Value(std::lerp(curve.FirstParameter(), curve.LastParameter(), share));
      EXPECT_NEAR(p.Distance(curve.Ellipse().Location()), 2, 0.01);
    }
  }
  EXPECT_EQ(found, 2);
}

TEST(DivideBends, EdgesWhosePipesFoldAreDividedWhereTheyBendMost) {
  const TopoDS_Shape shape = heal(obliquelyDrilled(), {.tolerance = 1e-5}).shape;
  const auto edgesOf = [](const TopoDS_Shape& part) {
    TopTools_IndexedMapOfShape edges;
    TopExp::MapShapes(part, TopAbs_EDGE, edges);
    return edges.Extent();
  };
  const TopoDS_Shape divided = divideBends(shape, 1, kSmoothAngle);
  EXPECT_EQ(edgesOf(divided), edgesOf(shape) + 2);
  EXPECT_TRUE(BRepCheck_Analyzer(divided).IsValid());
  EXPECT_TRUE(divideBends(shape, 0.4, kSmoothAngle).IsSame(shape));
  EXPECT_TRUE(divideBends(shape, -1, kSmoothAngle).IsSame(shape));  // no pipes there
}

}  // namespace
}  // namespace phront::cad
