// A spline may stand for an offset surface only where nothing else changes.
#include "patches/spline_surface.h"

#include <gtest/gtest.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_OffsetSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>

#include "exchange/tolerances.h"

namespace phront::cad {
namespace {

constexpr double kDistance = 0.3;

Handle(Geom_Surface) bump() {
  TColgp_Array2OfPnt poles(1, 4, 1, 4);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      poles.SetValue(i + 1, j + 1, gp_Pnt(i, j, i % 3 == 0 || j % 3 == 0 ? 0 : 0.8));
  return new Geom_BezierSurface(poles);
}

/// Two parabolas that meet smoothly, one bent more than the other.
Handle(Geom_BSplineCurve) unevenProfile() {
  TColgp_Array1OfPnt poles(1, 4);
  poles.SetValue(1, gp_Pnt(2, 0, 0));
  poles.SetValue(2, gp_Pnt(3, 1, 0));
  poles.SetValue(3, gp_Pnt(3, 2, 0));
  poles.SetValue(4, gp_Pnt(2, 6, 0));
  TColStd_Array1OfReal knots(1, 3);
  TColStd_Array1OfInteger multiplicities(1, 3);
  for (int k = 0; k < 3; ++k) {
    knots.SetValue(k + 1, k);
    multiplicities.SetValue(k + 1, k == 1 ? 1 : 3);
  }
  return new Geom_BSplineCurve(poles, knots, multiplicities, 2);
}

TopoDS_Face offsetFace(const Handle(Geom_Surface) & basis) {
  return BRepBuilderAPI_MakeFace(new Geom_OffsetSurface(basis, kDistance), 1e-7).Face();
}

TEST(SplineSurface, HasTheParametersAndTheEdgesOfTheOffsetSurface) {
  const TopoDS_Face face = offsetFace(bump());
  const Handle(Geom_Surface) exact = BRep_Tool::Surface(face);
  for (const double tolerance : {1e-3, 1e-5}) {
    const TopoDS_Face copy = offsetFace(bump());
    ASSERT_TRUE(useSpline(copy, tolerance));
    const BRepAdaptor_Surface spline(copy, Standard_False);
    EXPECT_EQ(spline.GetType(), GeomAbs_BSplineSurface);
    for (int i = 0; i <= 23; ++i)
      for (int j = 0; j <= 23; ++j)
        EXPECT_LE(spline.Value(i / 23.0, j / 23.0).Distance(exact->Value(i / 23.0, j / 23.0)),
                  tolerance);
    int edges = 0;
    for (TopExp_Explorer it(copy, TopAbs_EDGE); it.More(); it.Next(), ++edges) {
      double first = 0;
      double last = 0;
      EXPECT_FALSE(
          BRep_Tool::CurveOnSurface(TopoDS::Edge(it.Current()), copy, first, last).IsNull());
      EXPECT_TRUE(
          BRep_Tool::CurveOnSurface(TopoDS::Edge(it.Current()), face, first, last).IsNull());
      raiseTolerance(TopoDS::Edge(it.Current()), copy);
      EXPECT_LE(BRep_Tool::Tolerance(TopoDS::Edge(it.Current())), 2 * tolerance);
    }
    EXPECT_EQ(edges, 4);
    EXPECT_TRUE(BRepCheck_Analyzer(copy).IsValid());
  }
}

TEST(SplineSurface, IsNotUsedForOtherSurfaces) {
  const TopoDS_Face face = BRepBuilderAPI_MakeFace(bump(), 1e-7).Face();
  EXPECT_FALSE(useSpline(face, 1e-3));
  EXPECT_TRUE(BRep_Tool::Surface(face)->IsKind(STANDARD_TYPE(Geom_BezierSurface)));
}

TEST(SplineSurface, IsNotUsedWhereTheFaceHasASeam) {
  const TopoDS_Face face = offsetFace(new Geom_SurfaceOfRevolution(unevenProfile(), gp::OY()));
  EXPECT_FALSE(useSpline(face, 1e-3));
  EXPECT_TRUE(BRep_Tool::Surface(face)->IsKind(STANDARD_TYPE(Geom_OffsetSurface)));
}

TEST(SplineSurface, IsNotUsedWhereTheOffsetHasAKinkInItsParameters) {
  const Handle(Geom_Surface) basis =
      new Geom_SurfaceOfLinearExtrusion(unevenProfile(), gp_Dir(0, 0, 1));
  const TopoDS_Face face =
      BRepBuilderAPI_MakeFace(new Geom_OffsetSurface(basis, kDistance), 0, 2, 0, 1, 1e-7).Face();
  EXPECT_FALSE(useSpline(face, 1e-6));
  EXPECT_TRUE(BRep_Tool::Surface(face)->IsKind(STANDARD_TYPE(Geom_OffsetSurface)));
  EXPECT_TRUE(BRepCheck_Analyzer(face).IsValid());
}

}  // namespace
}  // namespace phront::cad
