// Offsets whose volume is known: Steiner's formula for convex solids, elementary geometry else.
#include "rebuild/exact_offset.h"

#include <gtest/gtest.h>
#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_Curve.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <gp.hxx>
#include <gp_Ax2.hxx>
#include <gp_Circ.hxx>
#include <gp_Trsf.hxx>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "exchange/measures.h"
#include "heal/heal.h"
#include "patches/patch_tools.h"
#include "patches/raw_complex.h"
#include "phront/cad/exchange.h"
#include "phront/cad/offset_shape.h"
#include "rebuild/cells.h"
#include "rebuild/select.h"
#include "solids.h"

namespace phront::cad {
namespace {

constexpr double kPi = std::numbers::pi;

double volumeOf(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties);
  return properties.Mass();
}

double areaOf(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(shape, properties);
  return properties.Mass();
}

int count(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(shape, kind, map);
  return map.Extent();
}

TrueDistance distanceOf(const TopoDS_Shape& shape, BodyKind kind, double distance) {
  Body body = test::solidBody(shape);
  body.kind = kind;
  auto mesh = tessellate(body, {.deflection = 0.02 * std::abs(distance)});
  EXPECT_TRUE(mesh) << (mesh ? "" : mesh.error().message);
  auto phi = TrueDistance::build(shape, std::move(*mesh));
  EXPECT_TRUE(phi) << (phi ? "" : phi.error().message);
  return std::move(*phi);
}

Result<AttemptResult> offset(const TopoDS_Shape& shape, double distance, bool solid = true) {
  const TrueDistance phi = distanceOf(shape, solid ? BodyKind::Solid : BodyKind::Sheet, distance);
  return tryExactOffset(shape, solid, distance, phi, attemptSettings().front());
}

/// A valid closed result of the given volume. Exact surfaces: only integration error is allowed.
void expectVolume(const TopoDS_Shape& shape, double distance, double volume, int solids = 1) {
  const Result<AttemptResult> result = offset(shape, distance);
  ASSERT_TRUE(result) << result.error().message;
  ASSERT_FALSE(result->shape.IsNull());
  EXPECT_TRUE(BRepCheck_Analyzer(result->shape).IsValid());
  EXPECT_EQ(result->openEdges, 0);
  EXPECT_EQ(countOpenEdges(result->shape), 0);
  EXPECT_EQ(count(result->shape, TopAbs_SOLID), solids);
  EXPECT_NEAR(volumeOf(result->shape), volume, 1e-5 * volume);
  EXPECT_FALSE(result->notes.empty());
}

TopoDS_Shape cut(const TopoDS_Shape& shape, const TopoDS_Shape& tool) {
  const TopoDS_Shape rest = BRepAlgoAPI_Cut(shape, tool).Shape();
  return TopExp_Explorer(rest, TopAbs_SOLID).Current();
}

TopoDS_Shape boxWithHole(double side, double height, double radius) {
  const gp_Ax2 axis(gp_Pnt(side / 2, side / 2, -1), gp_Dir(0, 0, 1));
  return cut(test::box(side, side, height),
             BRepPrimAPI_MakeCylinder(axis, radius, height + 2).Shape());
}

TEST(ExactOffset, BoxGrowsBySteiner) {
  const double d = 1.5;
  const double edges = 4 * (10 + 20 + 30);
  const double faces = 2 * (10 * 20 + 20 * 30 + 30 * 10);
  expectVolume(test::box(10, 20, 30), d,
               6000 + faces * d + edges * kPi / 4 * d * d + 4 * kPi / 3 * d * d * d);
}

TEST(ExactOffset, BoxShrinksToBox) { expectVolume(test::box(10, 20, 30), -1.5, 7.0 * 17.0 * 27.0); }

TEST(ExactOffset, BoxThinnerThanTwiceTheDistanceLeavesNothing) {
  const Result<AttemptResult> result = offset(test::box(10, 20, 30), -6);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_TRUE(result->shape.IsNull());
  EXPECT_EQ(result->keptFaces, 0);
  EXPECT_GT(result->rawFaces, 0);
}

TEST(ExactOffset, CylinderBothWays) {
  const double r = 10;
  const double h = 30;
  const double d = 2;
  // Pappus: body, mantle, two caps, and a quarter disc turned about the axis at each rim.
  const double rim = kPi * d * d / 4 * 2 * kPi * (r + 4 * d / (3 * kPi));
  expectVolume(test::cylinder(r, h), d,
               kPi * (r + d) * (r + d) * h + 2 * kPi * r * r * d + 2 * rim);
  expectVolume(test::cylinder(r, h), -d, kPi * (r - d) * (r - d) * (h - 2 * d));
}

TEST(ExactOffset, SphereAndTorusStayWhatTheyAre) {
  expectVolume(test::sphere(10), 2, 4 * kPi / 3 * 12 * 12 * 12);
  expectVolume(test::sphere(10), -2, 4 * kPi / 3 * 8 * 8 * 8);
  expectVolume(test::torus(20, 6), 2, 2 * kPi * 20 * kPi * 8 * 8);
  expectVolume(test::torus(20, 6), -2, 2 * kPi * 20 * kPi * 4 * 4);
}

TEST(ExactOffset, ConeGetsACapAndKeepsItsApexInside) {
  const double r = 10;
  const double h = 20;
  const double d = 1;
  const double slant = std::hypot(r, h);
  const double area = kPi * r * r + kPi * r * slant;
  // Integral of mean curvature: the rim with its outer angle, the mantle cot(half angle) * pi * r.
  const double rimAngle = kPi - std::atan2(h, r);
  const double curvature = kPi * r * rimAngle + kPi * h;
  expectVolume(test::cone(r, h), d,
               kPi * r * r * h / 3 + area * d + curvature * d * d + 4 * kPi / 3 * d * d * d);
  // Inwards a cone of the same angle: the insphere radius shrinks by d.
  const double inner = r * h / (r + slant);
  const double scale = (inner - d) / inner;
  expectVolume(test::cone(r, h), -d, scale * scale * scale * kPi * r * r * h / 3);
}

// The rulings of a B-spline cone run to the apex or from it, as its maker liked.
TEST(ExactOffset, ConesOfBSplinesAreCones) {
  const double d = 1;
  gp_Trsf turn;
  turn.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(1, 2, -1)), 0.7);
  const TopoDS_Shape whole = test::transformed(test::cone(10, 20), turn);
  const TopoDS_Shape half =
      test::transformed(TopoDS_Shape(BRepPrimAPI_MakeCone(10.0, 0.0, 20.0, kPi).Solid()), turn);
  for (const TopoDS_Shape& cone : {whole, half}) {
    const Result<AttemptResult> wanted = offset(cone, d);
    ASSERT_TRUE(wanted) << wanted.error().message;
    const TopoDS_Shape nurbs = BRepBuilderAPI_NurbsConvert(cone, Standard_True).Shape();
    expectVolume(makeElementary(nurbs, 1e-6).shape, d, volumeOf(wanted->shape));
  }
}

TEST(ExactOffset, KnifeEdgesGetHalfPipesAndTheirEnds) {
  // A square bar less a cylinder that touches two of its sides where they end.
  const double side = 2;
  const double height = 3;
  const double d = 0.5;
  BRepBuilderAPI_MakeWire outline;
  const gp_Circ circle(gp_Ax2(gp_Pnt(0, side, 0), gp::DZ()), side);
  outline.Add(BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 0), gp_Pnt(side, 0, 0)).Edge());
  outline.Add(BRepBuilderAPI_MakeEdge(gp_Pnt(side, 0, 0), gp_Pnt(side, side, 0)).Edge());
  outline.Add(BRepBuilderAPI_MakeEdge(circle, gp_Pnt(0, 0, 0), gp_Pnt(side, side, 0)).Edge());
  const TopoDS_Shape bar =
      BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(outline.Wire()).Face(), gp_Vec(0, 0, height))
          .Shape();
  const double area = (1 - kPi / 4) * side * side;
  const double perimeter = (2 + kPi / 2) * side;
  expectVolume(bar, d,
               height * (area + perimeter * d + kPi * d * d) +
                   2 * (area * d + perimeter * kPi * d * d / 4 + 2 * kPi / 3 * d * d * d));
}

TEST(ExactOffset, FilletedBoxShrinksThroughItsFillets) {
  // Rounded box = inner box + ball: offset by -1 leaves rounding 2.
  const double inner = 20 - 2 * 3;
  const double r = 2;
  expectVolume(test::filletedBox(20, 3), -1,
               inner * inner * inner + 6 * inner * inner * r + 3 * inner * kPi * r * r +
                   4 * kPi / 3 * r * r * r);
}

TEST(ExactOffset, HoleSmallerThanTheDistanceCloses) {
  // Above the hole two spindles meet on the axis: the hole of radius r leaves a dimple on each
  // side.
  const double side = 40;
  const double height = 10;
  const double r = 2;
  const double d = 3;
  const double faces = 2 * side * side + 4 * side * height;
  const double edges = 8 * side + 4 * height;
  const double full =
      side * side * height + faces * d + edges * kPi / 4 * d * d + 4 * kPi / 3 * d * d * d;
  // Missing above the hole: 2 pi * integral of rho * (d - sqrt(d^2 - (r - rho)^2)).
  double dimple = 0;
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    const double rho = (i + 0.5) * r / kSteps;
    dimple += 2 * kPi * rho * (d - std::sqrt(d * d - (r - rho) * (r - rho))) * r / kSteps;
  }
  expectVolume(boxWithHole(side, height, r), d, full - 2 * dimple);
}

TEST(ExactOffset, HoleGrowsInwards) {
  expectVolume(boxWithHole(40, 10, 5), -2, 36.0 * 36.0 * 6.0 - kPi * 49 * 6);
}

TEST(ExactOffset, ConcaveEdgeNeedsNoPatch) {
  // L of 2 x 2 x 1 inwards: of the shrunk square goes the cut-out, grown by d with a round corner.
  const double d = 0.2;
  const double side = 1 - d;  // of the cut-out inside the shrunk square
  const double grown = side * side + 2 * side * d + kPi / 4 * d * d;
  expectVolume(test::lShape(), -d, ((2 - 2 * d) * (2 - 2 * d) - grown) * (1 - 2 * d));
}

TEST(ExactOffset, GapOfACombCloses) {
  // Two teeth with a gap of 4 over a base; d = 2.5 fills the gap but for the grooves at its mouth.
  const TopoDS_Shape comb = cut(test::box(24, 20, 20),
                                BRepPrimAPI_MakeBox(gp_Pnt(10, -1, 5), gp_Pnt(14, 30, 30)).Shape());
  const Result<AttemptResult> result = offset(comb, 2.5);
  ASSERT_TRUE(result) << result.error().message;
  ASSERT_FALSE(result->shape.IsNull());
  EXPECT_TRUE(BRepCheck_Analyzer(result->shape).IsValid());
  EXPECT_EQ(count(result->shape, TopAbs_SOLID), 1);
  EXPECT_EQ(count(result->shape, TopAbs_SHELL), 1);
  // Between the grown block without the gap and that less the groove's bounding box.
  const double d = 2.5;
  const double full = 24.0 * 20 * 20 + 2 * (24 * 20 + 20 * 20 + 20 * 24) * d +
                      4 * (24 + 20 + 20) * kPi / 4 * d * d + 4 * kPi / 3 * d * d * d;
  const double depth = d - std::sqrt(d * d - 4);
  const double groove = 4 * depth * (20 + 2 * 15 + 2 * 4);
  EXPECT_LT(volumeOf(result->shape), full);
  EXPECT_GT(volumeOf(result->shape), full - groove);
}

TEST(ExactOffset, PartFallsApart) {
  // Two blocks of 10 joined by a bridge of thickness 2: inwards by 1.5 the bridge goes.
  const TopoDS_Shape dumbbell = cut(
      test::box(30, 10, 10), BRepPrimAPI_MakeBox(gp_Pnt(10, -1, 2), gp_Pnt(20, 11, 11)).Shape());
  const Result<AttemptResult> result = offset(dumbbell, -1.5);
  ASSERT_TRUE(result) << result.error().message;
  ASSERT_FALSE(result->shape.IsNull());
  EXPECT_EQ(count(result->shape, TopAbs_SOLID), 2);
  // Below the bridge's upper corner a strip stays beyond the cube: between the plane and the round
  // of radius d about that corner, half as high as the bridge is thinner than 2 d.
  const double d = 1.5;
  const double s = 2 - d;
  const double strip = d * s - (s * std::sqrt(d * d - s * s) + d * d * std::asin(s / d)) / 2;
  const double exact = 2 * 7.0 * (7.0 * 7.0 + strip);
  EXPECT_NEAR(volumeOf(result->shape), exact, 1e-5 * exact);
}

TEST(ExactOffset, CavityStays) {
  const TopoDS_Shape hollow =
      cut(test::box(20, 20, 20), BRepPrimAPI_MakeBox(gp_Pnt(5, 5, 5), gp_Pnt(15, 15, 15)).Shape());
  const double d = 1;
  const double outer = 8000 + 2400 * d + 240 * kPi / 4 * d * d + 4 * kPi / 3 * d * d * d;
  expectVolume(hollow, d, outer - 8.0 * 8.0 * 8.0);
}

TEST(ExactOffset, SheetLiesOnTheSideOfItsNormals) {
  // Two sides of a box: along the normals the convex edge between them gets a pipe, on the other
  // side they shorten.
  const TopoDS_Shape block = test::box(10, 10, 10);
  BRepBuilderAPI_Sewing sewing(1e-6);
  for (TopExp_Explorer it(block, TopAbs_FACE); it.More(); it.Next()) {
    GProp_GProps properties;
    BRepGProp::SurfaceProperties(it.Current(), properties);
    const gp_Pnt centre = properties.CentreOfMass();
    if (centre.X() > 9 || centre.Z() > 9) sewing.Add(it.Current());
  }
  sewing.Perform();
  const TopoDS_Shape sheet = sewing.SewedShape();
  const Result<AttemptResult> out = offset(sheet, 2, false);
  ASSERT_TRUE(out) << out.error().message;
  ASSERT_FALSE(out->shape.IsNull());
  EXPECT_EQ(count(out->shape, TopAbs_FACE), 3);
  EXPECT_NEAR(areaOf(out->shape), 200 + kPi / 2 * 2 * 10, 1e-6);
  const Result<AttemptResult> in = offset(sheet, -2, false);
  ASSERT_TRUE(in) << in.error().message;
  ASSERT_FALSE(in->shape.IsNull());
  EXPECT_EQ(count(in->shape, TopAbs_FACE), 2);
  EXPECT_NEAR(areaOf(in->shape), 160, 1e-6);
}

TEST(ArcPool, ArcsPassBothEndsTheShortWay) {
  const gp_Pnt centre(1, 2, 3);
  const auto vertexAt = [&](double angle) {
    return makeVertex(centre.Translated(gp_Vec(2 * std::cos(angle), 2 * std::sin(angle), 0)), 1e-7);
  };
  const gp_Vec leaning(0.3, 0.1, 1);  // as the tangent of a badly drawn edge
  ArcPool arcs;
  // A quarter; and ends in the wrong order, by round-off.
  for (const double to : {kPi / 2, -1e-4}) {
    const TopoDS_Edge arc = arcs.arc(centre, leaning, 2, vertexAt(0), vertexAt(to));
    double first = 0;
    double last = 0;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(arc, first, last);
    EXPECT_NEAR(last - first, std::abs(to), 1e-6);
    EXPECT_LT(curve->Value(first).Distance(BRep_Tool::Pnt(TopExp::FirstVertex(arc))), 1e-4);
    EXPECT_LT(curve->Value(last).Distance(BRep_Tool::Pnt(TopExp::LastVertex(arc))), 1e-4);
  }
}

/// Both ends of a cylinder, one cut off at 45 degrees: its edge is an ellipse.
TopoDS_Shape slantedCylinder() {
  const gp_Dir slant(1, 0, 1);
  const TopoDS_Shape above =
      BRepPrimAPI_MakeBox(gp_Ax2(gp_Pnt(0, 0, 30), slant), 200, 200, 200).Shape();
  gp_Trsf centred;
  centred.SetTranslation(gp_Vec(gp_Ax2(gp_Pnt(), slant).XDirection()) * -100 +
                         gp_Vec(gp_Ax2(gp_Pnt(), slant).YDirection()) * -100);
  return cut(test::cylinder(10, 60), above.Moved(TopLoc_Location(centred)));
}

/// Half a nose of revolution whose profile meets the axis at an angle: its tip is a pole with
/// another normal all round.
TopoDS_Shape halfNose() {
  TColgp_Array1OfPnt poles(1, 4);
  poles(1) = gp_Pnt(0, 0, 30);
  poles(2) = gp_Pnt(5, 0, 25);
  poles(3) = gp_Pnt(10, 0, 12);
  poles(4) = gp_Pnt(10, 0, 0);
  BRepBuilderAPI_MakeWire wire;
  wire.Add(BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 0), gp_Pnt(0, 0, 30)));
  wire.Add(BRepBuilderAPI_MakeEdge(new Geom_BezierCurve(poles)));
  wire.Add(BRepBuilderAPI_MakeEdge(gp_Pnt(10, 0, 0), gp_Pnt(0, 0, 0)));
  return BRepPrimAPI_MakeRevol(BRepBuilderAPI_MakeFace(wire.Wire()).Face(), gp::OZ(), kPi).Shape();
}

// Nothing of a convex solid's patches is nearer to another of its features.
TEST(ExactOffset, PatchesOfConvexSolidsLieOnTheOffset) {
  constexpr double kDistance = 3;
  for (const TopoDS_Shape& solid : {slantedCylinder(), halfNose()}) {
    const double diagonal = diagonalOf(solid);
    const TrueDistance phi = distanceOf(solid, BodyKind::Solid, kDistance);
    const RawComplex raw =
        buildRawComplex(heal(solid, {.tolerance = 1e-5 * diagonal}).shape,
                        {.distance = kDistance, .smoothAngle = 0.01, .tolerance = 1e-6 * diagonal});
    EXPECT_EQ(raw.missing, 0);
    for (const TopoDS_Face& face : raw.faces) {
      for (const FaceSample& s : interiorSamples(face))
        EXPECT_NEAR(phi.foot(Vec3(s.point.X(), s.point.Y(), s.point.Z())).distance, kDistance,
                    1e-5 * diagonal);
      for (TopExp_Explorer v(face, TopAbs_VERTEX); v.More(); v.Next())
        EXPECT_LT(BRep_Tool::Tolerance(TopoDS::Vertex(v.Current())), 1e-4 * diagonal);
    }
    const Result<AttemptResult> result = offset(solid, kDistance);
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_TRUE(BRepCheck_Analyzer(result->shape).IsValid());
    EXPECT_EQ(countOpenEdges(result->shape), 0);
    EXPECT_EQ(result->keptFaces, result->rawFaces);
  }
}

// Plain integration takes rational surfaces for larger than their parts.
TEST(Heal, DividesRationalSurfacesAtTheirKinks) {
  const TopoDS_Shape nurbs = BRepBuilderAPI_NurbsConvert(test::sphere(10), Standard_True).Shape();
  const HealedShape healed = heal(nurbs, {.tolerance = 1e-4});
  ASSERT_FALSE(healed.notes.empty());
  EXPECT_EQ(healed.notes.front(), "division at kinks: 1 faces become 6");
  EXPECT_NEAR(accurateAreaOf(healed.shape), 400 * std::numbers::pi, 0.02);
}

// Mirrored parts have left-handed surfaces. The hole of this torus closes, so that its offset is
// written as an offset surface.
TEST(Heal, TurnsTheSurfacesOfMirroredParts) {
  const TopoDS_Shape ring = test::torus(10, 9);
  gp_Trsf mirror;
  mirror.SetMirror(gp_Ax2(gp_Pnt(0, 0, -5), gp::DZ()));
  const TopoDS_Shape mirrored = test::transformed(ring, mirror);
  const auto leftHanded = [](const TopoDS_Shape& shape) {
    int count = 0;
    for (TopExp_Explorer f(shape, TopAbs_FACE); f.More(); f.Next()) {
      const BRepAdaptor_Surface surface(TopoDS::Face(f.Current()));
      if (surface.GetType() == GeomAbs_Torus && !surface.Torus().Position().Direct()) ++count;
    }
    return count;
  };
  ASSERT_GT(leftHanded(mirrored), 0);
  const TopoDS_Shape healed = heal(mirrored, {.tolerance = 1e-4}).shape;
  EXPECT_EQ(leftHanded(healed), 0);
  EXPECT_TRUE(BRepCheck_Analyzer(healed).IsValid());
  EXPECT_NEAR(volumeOf(healed), volumeOf(ring), 1e-6 * volumeOf(ring));

  Model model;
  model.bodies.push_back(test::solidBody(mirrored));
  OffsetOptions options;
  options.distance = 2;
  const auto offset = offsetModel(model, options);
  ASSERT_TRUE(offset) << offset.error().message;
  EXPECT_TRUE(offset->report.check.pass());
  const auto path = std::filesystem::path(::testing::TempDir()) / "mirrored.step";
  ASSERT_TRUE(writeModel(offset->model, path));
  const auto back = readModel(path);
  ASSERT_TRUE(back) << back.error().message;
  const auto volume = [](const Model& m) { return volumeOf(occtShape(m.bodies.front().shape)); };
  EXPECT_NEAR(volume(*back), volume(offset->model), 1e-6 * volume(offset->model));
}

TEST(ExactOffset, RefusesNonsense) {
  const TopoDS_Shape block = test::box(1, 1, 1);
  const TrueDistance phi = distanceOf(block, BodyKind::Solid, 0.1);
  for (const double d : {0.0, std::nan("")}) {
    const Result<AttemptResult> result =
        tryExactOffset(block, true, d, phi, attemptSettings().front());
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::InvalidArgument);
  }
}

TEST(ExactOffset, SettingsHaveNamesAndLimits) {
  const std::vector<AttemptSetting> settings = attemptSettings();
  ASSERT_GE(settings.size(), 3U);
  for (const AttemptSetting& s : settings) {
    EXPECT_FALSE(s.name.empty());
    EXPECT_GT(s.timeLimit, 0);
  }
}

}  // namespace
}  // namespace phront::cad
