#include "phront/cad/check.h"

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GeomAPI_Interpolate.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_Curve.hxx>
#include <TColgp_HArray1OfPnt.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Wire.hxx>
#include <cmath>
#include <gp_Ax2.hxx>
#include <gp_Pln.hxx>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "exchange/measures.h"
#include "judge/check_sampling.h"
#include "judge/check_topology.h"
#include "phront/cad/shape_occt.h"

namespace phront::cad {
namespace {

using std::numbers::pi;

// ---- parts -----------------------------------------------------------------------------------

/// [-m, x + m] x [-m, y + m] x [-m, z + m].
TopoDS_Shape box(double x, double y, double z, double m = 0) {
  return BRepPrimAPI_MakeBox(gp_Pnt(-m, -m, -m), gp_Pnt(x + m, y + m, z + m)).Solid();
}

TopoDS_Shape boxAt(double x, double y, double z, double size, double height) {
  return BRepPrimAPI_MakeBox(gp_Pnt(x, y, z), gp_Pnt(x + size, y + size, z + height)).Solid();
}

TopoDS_Shape rounded(const TopoDS_Shape& shape, double radius) {
  BRepFilletAPI_MakeFillet fillet(shape);
  TopTools_IndexedMapOfShape edges;
  TopExp::MapShapes(shape, TopAbs_EDGE, edges);
  for (int i = 1; i <= edges.Extent(); ++i) fillet.Add(radius, TopoDS::Edge(edges(i)));
  return fillet.Shape();
}

/// The true offset of box(x, y, z) at d > 0.
TopoDS_Shape roundedBox(double x, double y, double z, double d) {
  return rounded(box(x, y, z, d), d);
}

TopoDS_Shape sphere(double radius, double x = 0) {
  return BRepPrimAPI_MakeSphere(gp_Pnt(x, 0, 0), radius).Solid();
}

TopoDS_Shape torus(double major, double minor) {
  return BRepPrimAPI_MakeTorus(major, minor).Solid();
}

TopoDS_Shape cylinder(double radius, double from, double to) {
  return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, from), gp_Dir(0, 0, 1)), radius, to - from)
      .Solid();
}

TopoDS_Shape rim(double radius, double d, double z) {
  return BRepPrimAPI_MakeTorus(gp_Ax2(gp_Pnt(0, 0, z), gp_Dir(0, 0, 1)), radius, d).Solid();
}

/// The true offset of cylinder(radius, 0, height) at d > 0: its hull is a union of three solids.
TopoDS_Shape roundedCylinder(double radius, double height, double d) {
  TopoDS_Shape tall = cylinder(radius, -d, height + d);
  TopoDS_Shape wide = cylinder(radius + d, 0, height);
  TopoDS_Shape sum = BRepAlgoAPI_Fuse(tall, wide).Shape();
  sum = BRepAlgoAPI_Fuse(sum, rim(radius, d, 0)).Shape();
  return BRepAlgoAPI_Fuse(sum, rim(radius, d, height)).Shape();
}

TopoDS_Shape together(const TopoDS_Shape& a, const TopoDS_Shape& b) {
  BRep_Builder builder;
  TopoDS_Compound compound;
  builder.MakeCompound(compound);
  builder.Add(compound, a);
  builder.Add(compound, b);
  return compound;
}

/// A wedge of half a degree along z, its edge `depth` below (x, y).
TopoDS_Shape groove(double x, double y, double depth, double height) {
  const double half = depth * std::tan(pi / 720);
  BRepBuilderAPI_MakePolygon outline(gp_Pnt(x - half, y, 0), gp_Pnt(x, y - depth, 0),
                                     gp_Pnt(x + half, y, 0), true);
  return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(outline.Wire()), gp_Vec(0, 0, height));
}

TopoDS_Shape plane(double size, double z) {
  return BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0, 0, z), gp_Dir(0, 0, 1)), 0, size, 0, size).Face();
}

Model modelOf(const std::vector<TopoDS_Shape>& shapes, BodyKind kind = BodyKind::Solid) {
  Model model;
  for (const TopoDS_Shape& shape : shapes) {
    Body body;
    body.shape = makeShape(shape);
    body.kind = kind;
    model.bodies.push_back(std::move(body));
  }
  return model;
}

// Fewer samples than by default: enough for these parts, and the tests stay quick.
CheckOptions quick(double distance) { return {.distance = distance, .samples = 4000}; }

CheckResult check(const TopoDS_Shape& in, const TopoDS_Shape& out, double distance) {
  const auto result = checkOffset(modelOf({in}), modelOf({out}), quick(distance));
  EXPECT_TRUE(result.has_value()) << result.error().message;
  return result.value_or(CheckResult{});
}

CheckResult checkEmpty(const TopoDS_Shape& in, double distance) {
  const auto result = checkOffset(modelOf({in}), Model{}, quick(distance));
  EXPECT_TRUE(result.has_value()) << result.error().message;
  return result.value_or(CheckResult{});
}

std::string reasonsOf(const CheckResult& result) {
  std::string all;
  for (const std::string& reason : result.reasons) all += reason + "\n";
  return all;
}

::testing::AssertionResult says(const CheckResult& result, const std::string& words) {
  if (reasonsOf(result).find(words) != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "\"" << words << "\" is not in: " << reasonsOf(result);
}

// ---- right results ---------------------------------------------------------------------------

TEST(Check, PassesBoxGrownWithRoundedEdges) {
  const CheckResult r = check(box(100, 60, 40), roundedBox(100, 60, 40, 5), 5);
  EXPECT_TRUE(r.pass()) << reasonsOf(r);
  EXPECT_TRUE(r.valid);
  EXPECT_TRUE(r.closed);
  EXPECT_EQ(r.solids, 1);
  EXPECT_EQ(r.faces, 26);
  // Steiner: V + S d + (edge lengths) pi d^2 / 4 + 4/3 pi d^3, to the accuracy of the integration.
  const double steiner = 240'000 + 24'800 * 5 + 4 * 200 * pi * 25 / 4 + 4.0 / 3 * pi * 125;
  EXPECT_NEAR(r.volume, steiner, 1e-6 * steiner);
  // Exact surfaces on both sides: what remains is round-off, far below a thousandth of d.
  EXPECT_LT(r.accuracyMax, 1e-6);
  EXPECT_LT(r.coverageMax, 1e-6);
  EXPECT_EQ(r.rightSide, 1);
}

TEST(Check, PassesShrunkBox) {
  const CheckResult r = check(box(100, 60, 40), box(100, 60, 40, -5), -5);
  EXPECT_TRUE(r.pass()) << reasonsOf(r);
  EXPECT_LT(r.accuracyMax, 1e-6);
}

TEST(Check, PassesSphereCylinderAndTorusBothWays) {
  for (const double d : {2.0, -2.0}) {
    const CheckResult ball = check(sphere(10), sphere(10 + d), d);
    EXPECT_TRUE(ball.pass()) << d << reasonsOf(ball);
    const CheckResult ring = check(torus(20, 5), torus(20, 5 + d), d);
    EXPECT_TRUE(ring.pass()) << d << reasonsOf(ring);
  }
  const CheckResult grown = check(cylinder(10, 0, 30), roundedCylinder(10, 30, 2), 2);
  EXPECT_TRUE(grown.pass()) << reasonsOf(grown);
  const CheckResult shrunk = check(cylinder(10, 0, 30), cylinder(8, 2, 28), -2);
  EXPECT_TRUE(shrunk.pass()) << reasonsOf(shrunk);
}

TEST(Check, MeasuresASphereOfSlightlyWrongRadius) {
  const CheckResult r = check(sphere(10), sphere(12.01), 2);  // half the tolerance of 0.02
  EXPECT_TRUE(r.pass()) << reasonsOf(r);
  EXPECT_NEAR(r.accuracyP99, 0.01, 1e-7);  // exact distances on a sphere: round-off only
  EXPECT_NEAR(r.accuracyMax, 0.01, 1e-7);
  EXPECT_NEAR(r.coverageP99, 0.01, 1e-7);
}

// The offset of a wall's foot lies in the material behind the other wall, 1 from both.
TEST(Check, PassesANarrowGrooveThatFillsUp) {
  const TopoDS_Shape block = BRepAlgoAPI_Cut(box(40, 20, 10), groove(20, 20, 5, 10)).Shape();
  const CheckResult result = check(block, rounded(box(40, 20, 10, 1), 1), 1);
  EXPECT_TRUE(result.pass()) << reasonsOf(result);
}

TEST(Check, PassesTwoBodiesThatMerge) {
  const Model in = modelOf({sphere(10), sphere(10, 23)});
  const Model out = modelOf({BRepAlgoAPI_Fuse(sphere(12), sphere(12, 23)).Shape()});
  const auto r = checkOffset(in, out, quick(2));
  ASSERT_TRUE(r.has_value()) << r.error().message;
  EXPECT_TRUE(r->pass()) << reasonsOf(*r);
}

// Distances have no side: a sheet on both sides covers all there is and is nowhere off.
TEST(Check, RefusesPatchesOnTheOtherSideOfASheet) {
  const double d = 2;
  const Result<CheckResult> r =
      checkOffset(modelOf({plane(50, 0)}, BodyKind::Sheet),
                  modelOf({plane(50, d), plane(20, -d)}, BodyKind::Sheet), quick(d));
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_LT(r->accuracyMax, 1e-6);
  EXPECT_LT(r->coverageMax, 1e-6);
  EXPECT_NEAR(r->rightSide, 2500.0 / 2900, 0.02);
  ASSERT_EQ(r->reasons.size(), 1U) << reasonsOf(*r);
  EXPECT_TRUE(says(*r, "wrong side"));
}

TEST(Check, PassesASheetOnTheSideOfItsNormal) {
  for (const double d : {3.0, -3.0}) {
    const auto r = checkOffset(modelOf({plane(50, 0)}, BodyKind::Sheet),
                               modelOf({plane(50, d)}, BodyKind::Sheet), quick(d));
    ASSERT_TRUE(r.has_value()) << r.error().message;
    EXPECT_TRUE(r->pass()) << reasonsOf(*r);
    const auto other = checkOffset(modelOf({plane(50, 0)}, BodyKind::Sheet),
                                   modelOf({plane(50, -d)}, BodyKind::Sheet), quick(d));
    ASSERT_TRUE(other.has_value()) << other.error().message;
    EXPECT_TRUE(says(*other, "missing"));
  }
}

TEST(Check, PassesEmptyResultOfAPartThatVanishes) {
  const CheckResult r = checkEmpty(box(100, 60, 40), -20.5);
  EXPECT_TRUE(r.pass()) << reasonsOf(r);
  EXPECT_TRUE(r.trueOffsetEmpty);
}

// ---- wrong results ---------------------------------------------------------------------------

// Next to none of the ordinary samples find it.
TEST(Check, ConfirmsTheLittleThatIsLeft) {
  const CheckResult result = check(box(20, 20, 20), box(20, 20, 20, -9.8), -9.8);
  EXPECT_TRUE(result.pass()) << reasonsOf(result);
  EXPECT_FALSE(check(box(20, 20, 20), box(20, 20, 20, -9.2), -9.8).pass());
}

TEST(Check, FailsSharpCorners) {
  EXPECT_TRUE(says(check(box(100, 60, 40), box(100, 60, 40, 5), 5), "inaccurate"));
}

TEST(Check, FailsWrongDistance) {
  EXPECT_TRUE(says(check(sphere(10), sphere(12.04), 2), "inaccurate"));
  EXPECT_TRUE(says(check(sphere(10), sphere(11.96), 2), "inaccurate"));
}

// A large tolerance closes a hole that the samples on the faces cannot see.
TEST(Check, FailsWhatMeetsOnlyWithinALargeTolerance) {
  for (const double gap : {0.1, 1.0}) {
    const TopoDS_Shape out = box(100, 60, 40, -2);
    const TopoDS_Vertex corner = TopoDS::Vertex(TopExp_Explorer(out, TopAbs_VERTEX).Current());
    const gp_Pnt moved = BRep_Tool::Pnt(corner).Translated(gp_Vec(0.6 * gap, 0, -0.8 * gap));
    BRep_Builder().UpdateVertex(corner, moved, 1.01 * gap);
    const CheckResult result = check(box(100, 60, 40), out, -2);
    EXPECT_EQ(result.pass(), gap < 0.16) << reasonsOf(result);
  }
}

TEST(Check, FailsWrongSide) {
  EXPECT_TRUE(says(check(sphere(10), sphere(8), 2), "wrong side"));
  EXPECT_TRUE(says(check(torus(20, 5), torus(20, 7), -2), "wrong side"));
}

TEST(Check, FailsMissingFace) {
  BRep_Builder builder;
  TopoDS_Shell shell;
  builder.MakeShell(shell);
  int i = 0;
  for (TopExp_Explorer f(roundedBox(100, 60, 40, 5), TopAbs_FACE); f.More(); f.Next()) {
    if (i++ != 3) builder.Add(shell, f.Current());
  }
  const CheckResult r = check(box(100, 60, 40), shell, 5);
  EXPECT_FALSE(r.closed);
  EXPECT_TRUE(says(r, "not closed"));
  EXPECT_TRUE(says(r, "no solid"));
}

TEST(Check, FailsMissingSecondSolid) {
  const auto r =
      checkOffset(modelOf({sphere(10), sphere(10, 40)}), modelOf({sphere(12)}), quick(2));
  ASSERT_TRUE(r.has_value()) << r.error().message;
  EXPECT_TRUE(says(*r, "missing"));
  EXPECT_NEAR(r->coverageMax, 40, 0.2);  // the far pole of the second sphere: 40 + 12 - 12
}

TEST(Check, FailsOverlapLeftIn) {
  const TopoDS_Shape in = together(sphere(10), sphere(10, 23));
  EXPECT_TRUE(says(check(in, together(sphere(12), sphere(12, 23)), 2), "inaccurate"));
}

TEST(Check, FailsTheSameSolidTwice) {
  // Valid, closed and everywhere at its distance: only that space is filled twice tells.
  const TopoDS_Shape right = roundedBox(100, 60, 40, 5);
  const auto result = checkOffset(modelOf({box(100, 60, 40)}), modelOf({right, right}), quick(5));
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->buried, 1);
  EXPECT_TRUE(says(*result, "overlaps itself"));
}

TEST(Check, MeasuresHowMuchOfTwoSolidsLiesInEachOther) {
  // Spheres of radius 12 about points 12 apart: each has a cap of height 6 in the other, a quarter.
  const auto result =
      checkOffset(modelOf({sphere(10)}), modelOf({sphere(12), sphere(12, 12)}), quick(2));
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->buried, 0.25, 0.02);
}

TEST(Check, FailsASolidTurnedInsideOut) {
  TopoDS_Shape out = sphere(12);
  out.Reverse();
  EXPECT_TRUE(says(check(sphere(10), out, 2), "no positive volume"));
}

TEST(Check, FindsASmallBumpAndASmallPit) {
  const TopoDS_Shape in = box(100, 60, 40);
  const TopoDS_Shape good = roundedBox(100, 60, 40, 5);
  // 0.0005 % of the area, less than a single sample stands for.
  const TopoDS_Shape bump = BRepAlgoAPI_Fuse(good, boxAt(50, 30, 44, 0.4, 1.5)).Shape();
  EXPECT_TRUE(says(check(in, bump, 5), "inaccurate in places"));
  const TopoDS_Shape pit = BRepAlgoAPI_Cut(good, boxAt(50, 30, 43, 2, 3)).Shape();
  EXPECT_TRUE(says(check(in, pit, 5), "inaccurate in places"));
}

TEST(Check, FailsAFloatingExtraSolid) {
  const TopoDS_Shape extra = BRepPrimAPI_MakeSphere(gp_Pnt(50, 30, 60), 1).Solid();
  const CheckResult r = check(box(100, 60, 40), together(roundedBox(100, 60, 40, 5), extra), 5);
  EXPECT_TRUE(says(r, "inaccurate in places"));
}

TEST(Check, FailsEmptyResultWhereSomethingRemains) {
  const CheckResult r = checkEmpty(box(100, 60, 40), -15);
  EXPECT_FALSE(r.trueOffsetEmpty);
  EXPECT_TRUE(says(r, "empty"));
  // A speck: half a cube of side 0.02 on a plate, 1e-7 of the area. No sample meets it.
  const TopoDS_Shape plate =
      BRepAlgoAPI_Fuse(box(100, 60, 4), boxAt(40, 20, 0, 10.02, 10.02)).Shape();
  EXPECT_TRUE(says(checkEmpty(plate, -5), "empty"));
}

TEST(Check, FailsResultWhereNothingShouldRemain) {
  const CheckResult r = check(box(100, 60, 40), box(100, 60, 40, -19), -21);
  EXPECT_TRUE(r.trueOffsetEmpty);
  EXPECT_TRUE(says(r, "not empty"));
}

// ---- the border ------------------------------------------------------------------------------

TEST(Check, GivesTheSameFiguresEveryTime) {
  const CheckResult a = check(torus(20, 5), torus(20, 7.01), 2);
  const CheckResult b = check(torus(20, 5), torus(20, 7.01), 2);
  EXPECT_GT(a.accuracyMax, 0);
  EXPECT_EQ(a.accuracyP99, b.accuracyP99);
  EXPECT_EQ(a.accuracyMax, b.accuracyMax);
  EXPECT_EQ(a.coverageP99, b.coverageP99);
  EXPECT_EQ(a.coverageMax, b.coverageMax);
  EXPECT_EQ(a.worstPoint, b.worstPoint);
}

TEST(Check, RefusesSenselessArguments) {
  const Model part = modelOf({box(1, 1, 1)});
  for (const double d :
       {0.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const auto r = checkOffset(part, part, {.distance = d});
    ASSERT_FALSE(r.has_value());
    EXPECT_EQ(r.error().code, ErrorCode::InvalidArgument);
  }
  const auto r = checkOffset(Model{}, part, {.distance = 1});
  ASSERT_FALSE(r.has_value());
  EXPECT_EQ(r.error().code, ErrorCode::InvalidArgument);
}

TEST(Check, StopsAtItsTimeLimit) {
  const auto r = checkOffset(modelOf({torus(20, 5)}), modelOf({torus(20, 7)}),
                             {.distance = 2, .timeLimit = 1e-3});
  ASSERT_FALSE(r.has_value());
  EXPECT_EQ(r.error().code, ErrorCode::ResourceLimit);
}

TEST(Check, CanBeCancelled) {
  const Progress cancel([](double, std::string_view) { return false; });
  const auto r = checkOffset(modelOf({sphere(1)}), modelOf({sphere(2)}), {.distance = 1}, cancel);
  ASSERT_FALSE(r.has_value());
  EXPECT_EQ(r.error().code, ErrorCode::Cancelled);
}

// ---- parts of the check ----------------------------------------------------------------------

TEST(CheckTopology, CountsABoxAndItsVolume) {
  const TopologyFigures t = measureTopology(box(2, 3, 4));
  EXPECT_EQ(t.solids, 1);
  EXPECT_EQ(t.shells, 1);
  EXPECT_EQ(t.faces, 6);
  EXPECT_TRUE(t.valid);
  EXPECT_TRUE(t.closed());
  EXPECT_EQ(t.badSolids, 0);
  EXPECT_NEAR(t.volume, 24, 1e-9);  // planar faces integrate exactly
}

TEST(CheckTopology, MeasuresGapsNotTolerances) {
  const TopoDS_Shape solid = box(2, 3, 4);
  const TopoDS_Edge edge = TopoDS::Edge(TopExp_Explorer(solid, TopAbs_EDGE).Current());
  BRep_Builder().UpdateEdge(edge, 0.5);
  BRep_Builder().UpdateVertex(TopExp::FirstVertex(edge), 0.5);
  EXPECT_LT(measureTopology(solid).widestGap, 1e-12);
  double first = 0;
  double last = 0;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, first, last);
  BRep_Builder().UpdateEdge(edge, Handle(Geom_Curve)::DownCast(curve->Translated({0, 0.3, 0.4})),
                            0.5);
  EXPECT_NEAR(measureTopology(solid).widestGap, 0.5, 1e-12);
}

TEST(CheckTopology, NoticesOneReversedSolidAmongTwo) {
  TopoDS_Shape small = sphere(1, 40);
  small.Reverse();
  const TopologyFigures t = measureTopology(together(sphere(10), small));
  EXPECT_GT(t.volume, 0);
  EXPECT_EQ(t.badSolids, 1);
}

TEST(CheckSampling, ArcsOfACubeHaveTheAreaOfItsRoundedEdges) {
  SampleRng rng(1);
  const double d = 0.5;
  double strips = 0;
  int cones = 0;
  const Box3 cube(Vec3(0, 0, 0), Vec3(3, 3, 3));
  for (const OffsetCandidate& c :
       roundingCandidates(box(3, 3, 3), d, {.perArea = 10, .perVertex = 4}, rng)) {
    EXPECT_NEAR(cube.exteriorDistance(c.point), d, 1e-12);
    if (c.weight == 0.5 * d * d / 4) {
      ++cones;
    } else {
      strips += c.weight;
    }
  }
  EXPECT_EQ(cones, 8 * 4);
  EXPECT_NEAR(strips, 12 * 3 * d * pi / 2, 1e-9);
}

TEST(CheckSampling, QuantilesFollowTheWeights) {
  WeightedErrors errors;
  errors.add(3, 1);
  errors.add(1, 98);
  errors.add(2, 1);
  EXPECT_EQ(errors.quantile(0.98), 1);
  EXPECT_EQ(errors.quantile(0.99), 2);
  EXPECT_EQ(errors.max(), 3);
  EXPECT_NEAR(errors.shareAbove(1.5), 0.02, 1e-15);
  errors.add(std::numeric_limits<double>::quiet_NaN(), 100);
  EXPECT_NEAR(errors.shareAbove(1.5), 0.51, 1e-15);  // what has no distance is not within tolerance
}

TEST(FacesWithoutTriangles, AWavyOutlineIsNoFold) {
  // OpenCASCADE's quick integral is a sixth off here, its triangles are not.
  constexpr int kWaves = 20;
  constexpr int kPoints = 8 * kWaves;
  const Handle(TColgp_HArray1OfPnt) points = new TColgp_HArray1OfPnt(1, kPoints);
  for (int i = 0; i < kPoints; ++i) {
    const double t = 2 * std::numbers::pi * i / kPoints;
    const double r = 10 + 2 * std::sin(kWaves * t);
    points->SetValue(i + 1, gp_Pnt(r * std::cos(t), r * std::sin(t), 0));
  }
  GeomAPI_Interpolate outline(points, Standard_True, 1e-7);
  outline.Perform();
  const TopoDS_Edge edge = BRepBuilderAPI_MakeEdge(outline.Curve());
  const TopoDS_Face face = BRepBuilderAPI_MakeFace(BRepBuilderAPI_MakeWire(edge).Wire(), true);
  const double truth = std::numbers::pi * (100 + 2);
  ASSERT_GT(std::abs(areaOf(face) - truth), 0.05 * truth) << "the case is not met any more";
  EXPECT_TRUE(facesWithoutTriangles(face, {0.01, 0.3}).empty());
}

}  // namespace
}  // namespace phront::cad
