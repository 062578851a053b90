// Trimmed offset surfaces of faces whose offsets are known.
#include "phront/cad/offset_surfaces.h"

#include <gtest/gtest.h>
#include <BRepAdaptor_Curve.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <GeomAPI_Interpolate.hxx>
#include <GeomAPI_PointsToBSpline.hxx>
#include <GeomAPI_PointsToBSplineSurface.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_OffsetSurface.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TColgp_HArray1OfPnt.hxx>
#include <TopoDS.hxx>
#include <gp_Circ.hxx>
#include <gp_Pln.hxx>

#include <cmath>
#include <numbers>

#include "phront/cad/offset_shape.h"
#include "solids.h"
#include "surfaces/contour.h"
#include "surfaces/loop_polygons.h"
#include "surfaces/offset_geom.h"
#include "surfaces/parameter_plane.h"

namespace phront::cad {
namespace {

constexpr double kPi = std::numbers::pi;

SurfacesResult surfacesOf(const Body& body, double distance,
                          std::optional<double> tolerance = std::nullopt) {
  Model model;
  model.bodies.push_back(body);
  Result<SurfacesResult> result =
      offsetSurfaces(model, {.distance = distance, .tolerance = tolerance});
  EXPECT_TRUE(result.has_value()) << result.error().message;
  if (!result) return {};
  for (const BodySurfaces& part : result->bodies)
    for (const FaceOffset& face : part.faces) EXPECT_EQ(face.trouble, "");
  EXPECT_LE(result->deviation(), *result->options.tolerance);
  for (const Body& made : result->model.bodies)
    EXPECT_TRUE(BRepCheck_Analyzer(occtShape(made.shape)).IsValid());
  return std::move(*result);
}
SurfacesResult surfacesOf(const TopoDS_Shape& solid, double distance) {
  return surfacesOf(test::solidBody(solid), distance);
}

double areaOf(const SurfacesResult& result) {
  double sum = 0;
  for (const Body& body : result.model.bodies) {
    GProp_GProps properties;
    BRepGProp::SurfaceProperties(occtShape(body.shape), properties);
    sum += properties.Mass();
  }
  return sum;
}

std::vector<TopoDS_Face> facesOf(const SurfacesResult& result) {
  std::vector<TopoDS_Face> faces;
  for (const Body& body : result.model.bodies)
    for (TopExp_Explorer it(occtShape(body.shape), TopAbs_FACE); it.More(); it.Next())
      faces.push_back(TopoDS::Face(it.Current()));
  return faces;
}

TEST(OffsetSurfaces, BoxGrowsByItsFacesAndShrinksToTheInnerBox) {
  const SurfacesResult grown = surfacesOf(test::box(10, 20, 30), 2);
  EXPECT_EQ(grown.count(FaceOffsetKind::Exact), 6);
  EXPECT_NEAR(areaOf(grown), 2 * (200 + 300 + 600), 1e-6);
  for (const FaceOffset& face : grown.bodies[0].faces) EXPECT_TRUE(face.whole);

  const SurfacesResult shrunk = surfacesOf(test::box(10, 20, 30), -2);
  // Cut where neighbours are met: up to the tolerance of 0.02.
  EXPECT_NEAR(areaOf(shrunk), 2 * (6 * 16 + 6 * 26 + 16 * 26), 2 * (6 + 16 + 26) * 4 * 0.02);
  for (const FaceOffset& face : shrunk.bodies[0].faces) {
    EXPECT_FALSE(face.whole);
    EXPECT_EQ(face.surfaces, 1);
  }
}

TEST(OffsetSurfaces, NothingIsLeftOfAThinPlate) {
  const SurfacesResult none = surfacesOf(test::box(10, 20, 3), -2);
  EXPECT_EQ(none.count(FaceOffsetKind::Vanished), 6);
  EXPECT_TRUE(none.model.bodies.empty());
}

TEST(OffsetSurfaces, RoundOnesKeepTheirKind) {
  const auto only = [](const SurfacesResult& result, const Handle(Standard_Type) & type) {
    int count = 0;
    for (const TopoDS_Face& face : facesOf(result))
      count += BRep_Tool::Surface(face)->IsKind(type) ? 1 : 0;
    return count;
  };
  for (const double d : {1.0, -1.0}) {
    const SurfacesResult cylinder = surfacesOf(test::cylinder(5, 20), d);
    EXPECT_EQ(only(cylinder, STANDARD_TYPE(Geom_CylindricalSurface)), 1);
    for (const TopoDS_Face& face : facesOf(cylinder)) {
      const auto surface = Handle(Geom_CylindricalSurface)::DownCast(BRep_Tool::Surface(face));
      if (!surface.IsNull()) {
        EXPECT_NEAR(surface->Radius(), 5 + d, 1e-12);
      }
    }
    const SurfacesResult ball = surfacesOf(test::sphere(5), d);
    EXPECT_EQ(only(ball, STANDARD_TYPE(Geom_SphericalSurface)), 1);
    EXPECT_NEAR(areaOf(ball), 4 * kPi * (5 + d) * (5 + d), 1e-6);
    const SurfacesResult ring = surfacesOf(BRepPrimAPI_MakeTorus(10, 3).Solid(), d);
    EXPECT_EQ(only(ring, STANDARD_TYPE(Geom_ToroidalSurface)), 1);
    EXPECT_NEAR(areaOf(ring), 4 * kPi * kPi * 10 * (3 + d), 1e-5);
    const SurfacesResult cone = surfacesOf(test::cone(5, 12), d);
    EXPECT_EQ(only(cone, STANDARD_TYPE(Geom_ConicalSurface)), 1);
  }
}

TEST(OffsetSurfaces, AHoleThatClosesVanishes) {
  const TopoDS_Shape plate = BRepAlgoAPI_Cut(
      test::box(20, 20, 5),
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(10, 10, -1), gp::DZ()), 1.5, 7).Solid());
  const SurfacesResult grown = surfacesOf(plate, 2);
  EXPECT_EQ(grown.count(FaceOffsetKind::Vanished), 1);
  EXPECT_EQ(grown.count(FaceOffsetKind::Exact), 6);
}

TEST(OffsetSurfaces, ConcaveEdgesCutBothFaces) {
  const TopoDS_Shape corner = BRepAlgoAPI_Cut(
      test::box(30, 10, 30), BRepPrimAPI_MakeBox(gp_Pnt(10, -1, 10), 21, 12, 21).Solid());
  const SurfacesResult grown = surfacesOf(corner, 3);
  int cut = 0;
  for (const FaceOffset& face : grown.bodies[0].faces) cut += face.whole ? 0 : 1;
  EXPECT_EQ(cut, 2);
  // The inner walls lose a strip as wide as the distance.
  GProp_GProps before;
  BRepGProp::SurfaceProperties(corner, before);
  EXPECT_NEAR(areaOf(grown), before.Mass() - 2 * 3 * 10, 2 * 10 * 0.03);
}

TopoDS_Face profile() {
  TColgp_Array1OfPnt points(1, 9);
  for (int i = 1; i <= 9; ++i) points(i) = gp_Pnt(4 + std::sin(0.8 * i), 0, 2.5 * (i - 1));
  const Handle(Geom_BSplineCurve) curve = GeomAPI_PointsToBSpline(points, 3, 5).Curve();
  const gp_Pnt top(1, 0, 20);
  const gp_Pnt bottom(1, 0, 0);
  BRepBuilderAPI_MakeWire wire;
  wire.Add(BRepBuilderAPI_MakeEdge(curve).Edge());
  wire.Add(BRepBuilderAPI_MakeEdge(curve->EndPoint(), top).Edge());
  wire.Add(BRepBuilderAPI_MakeEdge(top, bottom).Edge());
  wire.Add(BRepBuilderAPI_MakeEdge(bottom, curve->StartPoint()).Edge());
  return BRepBuilderAPI_MakeFace(wire.Wire()).Face();
}

TEST(OffsetSurfaces, SweptSplinesKeepTheirKind) {
  const TopoDS_Shape turned =
      BRepPrimAPI_MakeRevol(profile(), gp_Ax1(gp::Origin(), gp::DZ())).Shape();
  const TopoDS_Shape drawn = BRepPrimAPI_MakePrism(profile(), gp_Vec(0, 12, 0)).Shape();
  for (const double d : {0.5, -0.3}) {
    const SurfacesResult round = surfacesOf(turned, d);
    const SurfacesResult straight = surfacesOf(drawn, d);
    EXPECT_EQ(round.count(FaceOffsetKind::Fitted), 1);
    EXPECT_EQ(straight.count(FaceOffsetKind::Fitted), 1);
    int kinds = 0;
    for (const TopoDS_Face& face : facesOf(round))
      kinds += BRep_Tool::Surface(face)->IsKind(STANDARD_TYPE(Geom_SurfaceOfRevolution)) ? 1 : 0;
    for (const TopoDS_Face& face : facesOf(straight))
      kinds +=
          BRep_Tool::Surface(face)->IsKind(STANDARD_TYPE(Geom_SurfaceOfLinearExtrusion)) ? 1 : 0;
    EXPECT_EQ(kinds, 2);
  }
}

Handle(Geom_BSplineSurface) wavy() {
  TColgp_Array2OfPnt points(1, 12, 1, 8);
  for (int i = 1; i <= 12; ++i) {
    for (int j = 1; j <= 8; ++j)
      points(i, j) = gp_Pnt(2 * i, 2 * j, 1.2 * std::sin(0.5 * i) * std::cos(0.4 * j));
  }
  return GeomAPI_PointsToBSplineSurface(points, 3, 5, GeomAbs_C2, 1e-6).Surface();
}

TEST(OffsetSurfaces, ParametersAreKeptAndSidesAsked) {
  Body sheet = test::solidBody(BRepBuilderAPI_MakeFace(wavy(), 1e-6).Face());
  sheet.kind = BodyKind::Sheet;
  for (const bool reversed : {false, true}) {
    if (reversed) sheet.shape = makeShape(occtShape(sheet.shape).Reversed());
    const SurfacesResult result = surfacesOf(sheet, 0.4, 1e-3);
    ASSERT_EQ(facesOf(result).size(), 1U);
    const TopoDS_Face face = facesOf(result).front();
    const Handle(Geom_Surface) offset = BRep_Tool::Surface(face);
    const Handle(Geom_BSplineSurface) original = wavy();
    EXPECT_EQ(face.Orientation(), reversed ? TopAbs_REVERSED : TopAbs_FORWARD);
    double u0 = 0;
    double u1 = 0;
    double v0 = 0;
    double v1 = 0;
    original->Bounds(u0, u1, v0, v1);
    for (double s = 0.05; s < 1; s += 0.13) {
      for (double t = 0.05; t < 1; t += 0.13) {
        gp_Pnt p;
        gp_Vec du;
        gp_Vec dv;
        original->D1(u0 + s * (u1 - u0), v0 + t * (v1 - v0), p, du, dv);
        const gp_Vec n = du.Crossed(dv).Normalized() * (reversed ? -0.4 : 0.4);
        EXPECT_LE(offset->Value(u0 + s * (u1 - u0), v0 + t * (v1 - v0)).Distance(p.Translated(n)),
                  1e-3);
      }
    }
  }
}

TEST(OffsetSurfaces, WhereASheetBendsTooMuchItIsCut) {
  // The parabola z = x^2 / 2 drawn along y, radius 1 at its bottom, offset inwards by 1.5: what
  // folds is left out.
  const NurbsSurface trough{
      {2, {0, 0, 0, 1, 1, 1}},
      {1, {0, 0, 1, 1}},
      {{-3, 0, 4.5}, {0, 0, -4.5}, {3, 0, 4.5}, {-3, 9, 4.5}, {0, 9, -4.5}, {3, 9, 4.5}},
      {}};
  Body sheet = test::solidBody(BRepBuilderAPI_MakeFace(geomOf(trough), 1e-6).Face());
  sheet.kind = BodyKind::Sheet;
  const SurfacesResult inside = surfacesOf(sheet, 1.5);
  EXPECT_EQ(inside.bodies[0].faces[0].surfaces, 2);
  EXPECT_FALSE(inside.bodies[0].faces[0].whole);
  const SurfacesResult outside = surfacesOf(sheet, -1.5);
  EXPECT_EQ(outside.bodies[0].faces[0].surfaces, 1);

  // The offset of the sheet, which General Fuse cannot cut with itself, is made of these.
  Model model;
  model.bodies.push_back(sheet);
  OffsetOptions options;
  options.distance = 1.5;
  const auto offset = offsetModel(model, options);
  ASSERT_TRUE(offset.has_value()) << offset.error().message;
  EXPECT_TRUE(offset->accepted()) << offset->report.check.reasons.front();
  const BodyReport& report = offset->report.bodies.front();
  EXPECT_EQ(report.setting, "trimmed faces");
  EXPECT_EQ(report.fittedFaces, 2);
  EXPECT_EQ(report.facetedFaces, 0);
}

TEST(OffsetSurfaces, BadNumbersAreRefused) {
  Model model;
  model.bodies.push_back(test::solidBody(test::box(1, 1, 1)));
  const auto code = [&](const SurfacesOptions& options) {
    const auto result = offsetSurfaces(model, options);
    return result ? ErrorCode::Failed : result.error().code;
  };
  EXPECT_EQ(code({.distance = 0}), ErrorCode::InvalidArgument);
  EXPECT_EQ(code({.distance = NAN}), ErrorCode::InvalidArgument);
  EXPECT_EQ(code({.distance = 1, .tolerance = -1}), ErrorCode::InvalidArgument);
  EXPECT_EQ(code({.distance = 1, .timeLimit = 0}), ErrorCode::InvalidArgument);
  model.bodies.clear();
  EXPECT_EQ(code({.distance = 1}), ErrorCode::InvalidArgument);
  model.bodies.push_back(test::solidBody(test::box(1, 1, 1)));
  const auto cancelled = offsetSurfaces(model, {.distance = 0.1},
                                        Progress([](double, std::string_view) { return false; }));
  ASSERT_FALSE(cancelled.has_value());
  EXPECT_EQ(cancelled.error().code, ErrorCode::Cancelled);
}

TEST(OffsetGeom, SurfacesAreSplitAtTheirEdges) {
  // A roof as one surface of degree 1 across.
  const NurbsSurface plain{{1, {0, 0, 1, 2, 2}},
                           {1, {0, 0, 1, 1}},
                           {{-1, 1, 0}, {0, 1, 1}, {1, 1, 0}, {-1, 2, 0}, {0, 2, 1}, {1, 2, 0}},
                           {}};
  const Handle(Geom_Surface) roof = geomOf(plain);
  const auto pieces = offsetGeom(roof, {{0, 2}, {0, 1}}, {.distance = 0.2, .tolerance = 1e-6});
  ASSERT_TRUE(pieces.has_value()) << pieces.error().message;
  ASSERT_EQ(pieces->size(), 2U);
  EXPECT_EQ((*pieces)[0].box.u.high, 1);
  EXPECT_EQ((*pieces)[1].box.u.low, 1);
}

TEST(OffsetGeom, AnOffsetOfAnOffsetIsOne) {
  const Handle(Geom_Surface) cylinder = new Geom_CylindricalSurface(gp_Ax3(), 3);
  const Handle(Geom_Surface) offset = new Geom_OffsetSurface(cylinder, 1);
  const auto pieces = offsetGeom(offset, {{0, 1}, {0, 1}}, {.distance = 0.5, .tolerance = 1e-6});
  ASSERT_TRUE(pieces.has_value()) << pieces.error().message;
  ASSERT_EQ(pieces->size(), 1U);
  const auto made = Handle(Geom_CylindricalSurface)::DownCast(pieces->front().surface);
  ASSERT_FALSE(made.IsNull());
  EXPECT_NEAR(made->Radius(), 4.5, 1e-15);
  // Through its axis nothing is left.
  EXPECT_TRUE(offsetGeom(cylinder, {{0, 1}, {0, 1}}, {.distance = -3, .tolerance = 1e-6})->empty());
}

TEST(OffsetGeom, ConesPastTheirApexKeepTheirParameters) {
  const Handle(Geom_Surface) cone = new Geom_ConicalSurface(gp_Ax3(), 0.5, 1);
  for (const double d : {0.7, -0.7, -3.0}) {
    const auto pieces = offsetGeom(cone, {{0, 6}, {2, 9}}, {.distance = d, .tolerance = 1e-6});
    ASSERT_TRUE(pieces.has_value()) << pieces.error().message;
    for (double t = 2; t < 9; t += 0.7) {
      gp_Pnt p;
      gp_Vec du;
      gp_Vec dv;
      cone->D1(0.3 * t, t, p, du, dv);
      const gp_Vec n = du.Crossed(dv).Normalized();
      EXPECT_NEAR(pieces->front().surface->Value(0.3 * t, t).Distance(p.Translated(n * d)), 0,
                  1e-12);
    }
  }
}

TEST(Contour, FollowsACircleAndASquare) {
  // Clearance is flat where there is enough, as of a front that is not met.
  const ClearanceAt circle = [](const Vec2& x) {
    const double r = x.norm();
    return Clearance{std::min(r - 2, 0.01), r < 2.01 ? Vec2(x / r) : Vec2(0, 0)};
  };
  const ClearanceAt square = [](const Vec2& x) {
    const bool alongX = std::abs(x[0]) > std::abs(x[1]);
    const double r = alongX ? std::abs(x[0]) : std::abs(x[1]);
    const Vec2 up = alongX ? Vec2(std::copysign(1, x[0]), 0) : Vec2(0, std::copysign(1, x[1]));
    return Clearance{std::min(r - 2, 0.01), r < 2.01 ? up : Vec2(0, 0)};
  };
  const ContourOptions options{.low = {-5, -5}, .high = {5, 5}, .chord = 1e-3, .longestStep = 1};
  for (const bool round : {true, false}) {
    std::vector<Contour> lines;
    const std::vector<ContourSeed> seeds{{{0.1, 0.05}, {4, 0.3}}, {{0, -0.1}, {0.2, -3}}};
    traceContours(round ? circle : square, seeds, options, lines);
    ASSERT_EQ(lines.size(), 1U) << "both seeds lie on one line";
    EXPECT_TRUE(lines[0].closed);
    double length = 0;
    for (std::size_t i = 0; i < lines[0].points.size(); ++i) {
      const Vec2& a = lines[0].points[i];
      const Vec2& b = lines[0].points[(i + 1) % lines[0].points.size()];
      length += (b - a).norm();
      const double off = round ? std::abs((0.5 * (a + b)).norm() - 2)
                               : std::abs((0.5 * (a + b)).lpNorm<Eigen::Infinity>() - 2);
      EXPECT_LE(off, 2.5e-3);
    }
    EXPECT_NEAR(length, round ? 4 * kPi : 16, 0.02);
    EXPECT_LE(lines[0].points.size(), 120U);
  }
}

TEST(Contour, LinesEndOutsideTheBoxAndOnGridsToo) {
  const ClearanceAt half = [](const Vec2& x) {
    return Clearance{std::min(x[1] - 0.2 * x[0], 0.01), Vec2(-0.2, 1)};
  };
  const ContourOptions options{.low = {-5, -5}, .high = {5, 5}, .chord = 1e-3, .longestStep = 1};
  std::vector<Contour> lines;
  traceContours(half, {{{0, -1}, {0, 1}}}, options, lines);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_FALSE(lines[0].closed);
  EXPECT_GE(std::abs(lines[0].points.front()[0]), 5);
  EXPECT_GE(std::abs(lines[0].points.back()[0]), 5);
  std::vector<double> grid;
  for (int i = -16; i <= 16; ++i) grid.push_back(5.0 * i / 16);
  grid.insert(std::upper_bound(grid.begin(), grid.end(), 0.4), 0.4);
  const std::vector<Contour> onGrid = gridContours(half, options.chord, grid, grid);
  ASSERT_EQ(onGrid.size(), 1U);
  EXPECT_NEAR((onGrid[0].points.front() - onGrid[0].points.back()).norm(), 10 * std::hypot(1, 0.2),
              1e-2);
}

TEST(ParameterPlane, LinesDoNotBulgeBesideShortSegments) {
  // The corner of a square as it is traced: cut off by a side a hundred times shorter.
  Contour corner;
  corner.points = {{0, -4},         {0, -2},     {0, -0.5},  {0, -0.02},
                   {0.018, -0.016}, {2, -0.016}, {4, -0.016}};
  for (const TopoDS_Edge& edge : ParameterPlane::edgesAlong({corner}, 4e-3)) {
    const BRepAdaptor_Curve curve(edge);
    for (int i = 0; i <= 100; ++i) {
      const gp_Pnt p = curve.Value(curve.FirstParameter() +
                                   i * (curve.LastParameter() - curve.FirstParameter()) / 100);
      EXPECT_GE(p.X(), -4e-3);
      EXPECT_LE(p.Y(), -0.012);
    }
  }
}

TEST(LoopPolygons, FollowsASplineWhoseEndsAreLevel) {
  // A wave that is as high in the middle as at both ends.
  const Handle(TColgp_HArray1OfPnt) points = new TColgp_HArray1OfPnt(1, 41);
  for (int i = 0; i <= 40; ++i)
    points->SetValue(i + 1, gp_Pnt(0.1 * i, std::sin(std::numbers::pi * 0.1 * i), 0));
  GeomAPI_Interpolate through(points, Standard_False, 1e-9);
  through.Perform();
  const Handle(Geom_BSplineCurve) wave = through.Curve();
  BRepBuilderAPI_MakeWire wire(BRepBuilderAPI_MakeEdge(wave).Edge());
  wire.Add(BRepBuilderAPI_MakeEdge(gp_Pnt(4, 0, 0), gp_Pnt(4, 3, 0)).Edge());
  wire.Add(BRepBuilderAPI_MakeEdge(gp_Pnt(4, 3, 0), gp_Pnt(0, 3, 0)).Edge());
  wire.Add(BRepBuilderAPI_MakeEdge(gp_Pnt(0, 3, 0), gp_Pnt(0, 0, 0)).Edge());
  const LoopPolygons loops(BRepBuilderAPI_MakeFace(gp_Pln(), wire.Wire()).Face(), 1e-3);
  for (double x = 0.05; x < 4; x += 0.1) {
    const double y = std::sin(std::numbers::pi * x);
    EXPECT_TRUE(loops.contains({x, y + 0.05})) << x;
    EXPECT_FALSE(loops.contains({x, y - 0.05})) << x;
  }
}

TEST(LoopPolygons, KnowsHolesAndLeavesOutWhatIsNoLoop) {
  const gp_Pln plane;
  BRepBuilderAPI_MakeFace maker(plane, -2, 2, -2, 2);
  maker.Add(
      TopoDS::Wire(BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(gp_Circ(gp::XOY(), 1)).Edge())
                       .Wire()
                       .Reversed()));
  TopoDS_Face face = maker.Face();
  const TopoDS_Edge inside = BRepBuilderAPI_MakeEdge(gp_Pnt(1.2, -1, 0), gp_Pnt(1.2, 1, 0)).Edge();
  BRep_Builder().Add(face, BRepBuilderAPI_MakeWire(inside).Wire().Oriented(TopAbs_INTERNAL));
  const LoopPolygons loops(face, 1e-3);
  for (double x = -2.45; x < 2.5; x += 0.1) {
    for (double y = -2.45; y < 2.5; y += 0.1) {
      const bool held = std::max(std::abs(x), std::abs(y)) < 2 && std::hypot(x, y) > 1;
      EXPECT_EQ(loops.contains({x, y}), held) << x << ' ' << y;
    }
  }
}

}  // namespace
}  // namespace phront::cad
