// Elementary solids turned into B-splines are found again.
#include "heal/canonical.h"

#include <gtest/gtest.h>
#include <BRepAdaptor_Surface.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <Geom_ConicalSurface.hxx>
#include <ShapeUpgrade_ShapeDivideClosed.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <gp.hxx>
#include <gp_Ax3.hxx>

#include <map>
#include <numbers>

#include "heal/elementary_fit.h"
#include "heal/free_angle.h"
#include "heal/heal.h"
#include "solids.h"

namespace phront::cad {
namespace {

double volumeOf(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties, 1e-8);
  return properties.Mass();
}

std::map<GeomAbs_SurfaceType, int> surfacesOf(const TopoDS_Shape& shape) {
  std::map<GeomAbs_SurfaceType, int> count;
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  for (int i = 1; i <= faces.Extent(); ++i) {
    ++count[BRepAdaptor_Surface(TopoDS::Face(faces(i)), Standard_False).GetType()];
  }
  return count;
}

TopoDS_Shape asNurbs(const TopoDS_Shape& shape) {
  ShapeUpgrade_ShapeDivideClosed divide(shape);
  divide.SetNbSplitPoints(1);
  divide.Perform();
  return BRepBuilderAPI_NurbsConvert(divide.Result(), Standard_True).Shape();
}

/// All faces recognised, the solid valid and of the same size.
std::map<GeomAbs_SurfaceType, int> expectRecognised(const TopoDS_Shape& solid) {
  const TopoDS_Shape nurbs = asNurbs(solid);
  const auto before = surfacesOf(nurbs);
  EXPECT_EQ(before.size(), 1U);
  EXPECT_EQ(before.begin()->first, GeomAbs_BSplineSurface);
  const CanonicalShape result = recogniseSurfaces(nurbs, 1e-6);
  EXPECT_EQ(result.faces, before.begin()->second);
  EXPECT_LT(result.deviation, 1e-9);
  EXPECT_TRUE(BRepCheck_Analyzer(result.shape).IsValid());
  EXPECT_NEAR(volumeOf(result.shape), volumeOf(solid), 1e-6 * volumeOf(solid));
  EXPECT_EQ(result.shape.ShapeType(), nurbs.ShapeType());
  return surfacesOf(result.shape);
}

TEST(RecogniseSurfaces, FindsPlanes) {
  const auto found = expectRecognised(test::lShape());
  EXPECT_EQ(found.at(GeomAbs_Plane), 8);
  EXPECT_EQ(recogniseSurfaces(asNurbs(test::lShape()), 1e-6).edges, 18);
}

TEST(RecogniseSurfaces, FindsCylinders) {
  const auto found = expectRecognised(test::cylinder(2, 5));
  EXPECT_EQ(found.at(GeomAbs_Plane), 2);
  EXPECT_EQ(found.at(GeomAbs_Cylinder), 2);
}

TEST(RecogniseSurfaces, FindsCircles) {
  EXPECT_EQ(recogniseSurfaces(asNurbs(test::cylinder(2, 5)), 1e-6).edges, 6);
}

TEST(RecogniseSurfaces, FindsCylindersMostOfTheWayRound) {
  for (const double degrees : {120, 180, 240, 270, 300, 330}) {
    const TopoDS_Shape sector =
        BRepPrimAPI_MakeCylinder(5.0, 3.0, degrees * std::numbers::pi / 180).Solid();
    EXPECT_EQ(expectRecognised(sector).at(GeomAbs_Cylinder), 1) << degrees;
  }
}

TEST(RecogniseSurfaces, FindsConesUpToTheApex) {
  const TopoDS_Shape cone = test::cone(3, 7);
  EXPECT_EQ(expectRecognised(cone).at(GeomAbs_Cone), 2);
  const CanonicalShape result = recogniseSurfaces(asNurbs(cone), 1e-6);
  int apexes = 0;
  for (TopExp_Explorer e(result.shape, TopAbs_EDGE); e.More(); e.Next())
    if (BRep_Tool::Degenerated(TopoDS::Edge(e.Current()))) ++apexes;
  EXPECT_EQ(apexes, 2);
}

TEST(RecogniseSurfaces, FindsConesWithoutApex) {
  const TopoDS_Shape frustum = BRepPrimAPI_MakeCone(3.0, 1.0, 4.0).Solid();
  EXPECT_EQ(expectRecognised(frustum).at(GeomAbs_Cone), 2);
}

TEST(RecogniseSurfaces, FindsTori) {
  EXPECT_EQ(expectRecognised(test::torus(5, 1)).at(GeomAbs_Torus), 4);
}

TEST(RecogniseSurfaces, FindsFilletsAndWorksInPlaceAnywhere) {
  gp_Trsf move;
  move.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(1, 2, -1)), 0.7);
  move.SetTranslationPart(gp_Vec(100, -50, 20));
  const auto found = expectRecognised(test::transformed(test::filletedBox(10, 2), move));
  EXPECT_EQ(found.at(GeomAbs_Plane), 6);
  EXPECT_EQ(found.at(GeomAbs_Cylinder), 12);
  EXPECT_EQ(found.at(GeomAbs_Sphere), 8);
}

// Every axis across a half has its poles on the border.
TEST(RecogniseSurfaces, LeavesHalvesOfASphereAlone) {
  const TopoDS_Shape halves = asNurbs(test::sphere(5));
  EXPECT_EQ(recogniseSurfaces(halves, 1e-6).faces, 0);
}

TEST(MakeElementary, DividesASphereWhereItCanBeRecognised) {
  const TopoDS_Shape nurbs = BRepBuilderAPI_NurbsConvert(test::sphere(5), Standard_True).Shape();
  const TopoDS_Shape found = makeElementary(nurbs, 1e-6).shape;
  EXPECT_EQ(surfacesOf(found), (std::map<GeomAbs_SurfaceType, int>{{GeomAbs_Sphere, 3}}));
  EXPECT_TRUE(BRepCheck_Analyzer(found).IsValid());
  EXPECT_NEAR(volumeOf(found), volumeOf(nurbs), 1e-6 * volumeOf(nurbs));
  for (TopExp_Explorer e(found, TopAbs_EDGE); e.More(); e.Next())
    EXPECT_LT(BRep_Tool::Tolerance(TopoDS::Edge(e.Current())), 1e-4);
}

TEST(RecogniseSurfaces, LeavesFreeformAlone) {
  const TopoDS_Shape loft = test::loft();
  const auto before = surfacesOf(loft);
  const CanonicalShape result = recogniseSurfaces(loft, 1e-6);
  EXPECT_EQ(surfacesOf(result.shape)[GeomAbs_BSplineSurface], before.at(GeomAbs_BSplineSurface));
  EXPECT_NEAR(volumeOf(result.shape), volumeOf(loft), 1e-9 * volumeOf(loft));
}

TEST(RecogniseSurfaces, DoesNotTouchItsInput) {
  const TopoDS_Shape nurbs = asNurbs(test::box(1, 2, 3));
  const double volume = volumeOf(nurbs);
  (void)recogniseSurfaces(nurbs, 1e-6);
  EXPECT_EQ(surfacesOf(nurbs).at(GeomAbs_BSplineSurface), 6);
  EXPECT_DOUBLE_EQ(volumeOf(nurbs), volume);
}

TEST(FitElementary, RefusesWhatLiesOffTheSurface) {
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      const double bump = (i == 2 && j == 3) ? 1e-3 : 0;
      points.push_back({Vec3(i, j, bump), Vec3::UnitZ()});
    }
  }
  EXPECT_FALSE(fitElementary(points, 1e-4));
  EXPECT_TRUE(fitElementary(points, 2e-3));
}

TEST(WidestFreeAngle, IsWhereNothingLies) {
  using std::numbers::pi;
  const FreeAngle free = widestFreeAngle({0.5, -0.5, 2, 2 * pi + 1});
  EXPECT_NEAR(free.middle, (2 + 2 * pi - 0.5) / 2, 1e-12);
  EXPECT_NEAR(free.width, 2 * pi - 2.5, 1e-12);
  EXPECT_NEAR(widestFreeAngle({1}).middle, 1 + pi, 1e-12);
  EXPECT_NEAR(widestFreeAngle({1}).width, 2 * pi, 1e-12);
  EXPECT_NEAR(widestFreeAngle({}).width, 2 * pi, 1e-12);
}

TEST(FitElementary, NeedsPoints) {
  EXPECT_FALSE(fitElementary({}, 1e-6));
  const std::vector<SurfacePoint> one(20, {Vec3(1, 1, 1), Vec3::UnitX()});
  EXPECT_FALSE(fitElementary(one, 1e-6));
}

/// What a frustum becomes when its closed mantle is divided.
std::map<GeomAbs_SurfaceType, int> recognisedFrustum(double bottom, double top, double height) {
  const TopoDS_Shape frustum = BRepPrimAPI_MakeCone(bottom, top, height).Solid();
  ShapeUpgrade_ShapeDivideClosed divide(frustum);
  divide.SetNbSplitPoints(1);
  divide.Perform();
  const CanonicalShape result = recogniseSurfaces(divide.Result(), 1e-3);
  EXPECT_TRUE(BRepCheck_Analyzer(result.shape).IsValid());
  EXPECT_NEAR(volumeOf(result.shape), volumeOf(frustum), 1e-3 * volumeOf(frustum));
  return surfacesOf(result.shape);
}

TEST(RecogniseSurfaces, ConesByNameOnlyAreCylindersOrPlanes) {
  const auto upright = recognisedFrustum(10, 10.001, 5);
  EXPECT_FALSE(upright.contains(GeomAbs_Cone));
  EXPECT_EQ(upright.at(GeomAbs_Cylinder), 2);
  const auto real = recognisedFrustum(10, 10.1, 5);
  EXPECT_EQ(real.at(GeomAbs_Cone), 2);
  EXPECT_FALSE(real.contains(GeomAbs_Cylinder));
}

TEST(IsElementary, AsksForMoreThanTheNameOfACone) {
  const gp_Ax3 frame(gp_Pnt(0, 0, 0), gp::DZ(), gp::DX());
  const auto cone = [&](double half) {
    const TopoDS_Face face =
        BRepBuilderAPI_MakeFace(new Geom_ConicalSurface(frame, half, 10), 0, 1, 0, 1, 1e-7).Face();
    return isElementary(BRepAdaptor_Surface(face));
  };
  EXPECT_TRUE(cone(0.3));
  EXPECT_TRUE(cone(-0.3));
  EXPECT_FALSE(cone(1e-4));
  EXPECT_FALSE(cone(std::numbers::pi / 2 - 1e-4));
}

}  // namespace
}  // namespace phront::cad
