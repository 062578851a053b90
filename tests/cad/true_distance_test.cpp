#include "tessellate/true_distance.h"

#include <gtest/gtest.h>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepLib.hxx>
#include <GCE2d_MakeSegment.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_OffsetSurface.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <gp_Ax2.hxx>
#include <gp_Ax3.hxx>
#include <gp_Trsf.hxx>

#include <array>
#include <chrono>
#include <functional>
#include <numbers>
#include <random>

#include "solids.h"
#include "tessellate/face_surface.h"

namespace phront::cad {
namespace {

TrueDistance exactDistance(const TopoDS_Shape& shape, double deflection,
                           BodyKind kind = BodyKind::Solid) {
  Body body = test::solidBody(shape);
  body.kind = kind;
  auto mesh = tessellate(body, {.deflection = deflection});
  EXPECT_TRUE(mesh) << (mesh ? "" : mesh.error().message);
  auto distance = TrueDistance::build(shape, std::move(*mesh));
  EXPECT_TRUE(distance) << (distance ? "" : distance.error().message);
  return std::move(*distance);
}

std::vector<Vec3> randomPoints(int count, const Vec3& low, const Vec3& high) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const Vec3 t(uniform(random), uniform(random), uniform(random));
    points.push_back(low + t.cwiseProduct(high - low));
  }
  return points;
}

double boxPhi(const Vec3& x, const Vec3& size) {
  const Vec3 q = (x - 0.5 * size).cwiseAbs() - 0.5 * size;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}
double cylinderPhi(const Vec3& x, double radius, double height) {
  const Eigen::Vector2d q(x.head<2>().norm() - radius, std::abs(x.z() - height / 2) - height / 2);
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}
double spherePhi(const Vec3& x, double radius) { return x.norm() - radius; }
double torusPhi(const Vec3& x, double major, double minor) {
  return Eigen::Vector2d(x.head<2>().norm() - major, x.z()).norm() - minor;
}

struct Case {
  const char* name;
  TopoDS_Shape shape;
  std::function<double(const Vec3&)> phi;
  Vec3 low, high;
};

std::vector<Case> cases() {
  return {
      {"box",
       test::box(1, 2, 3),
       [](const Vec3& x) {
         return boxPhi(x, {1, 2, 3});
       },
       {-1, -1, -1},
       {2, 3, 4}},
      {"cylinder",
       test::cylinder(1, 3),
       [](const Vec3& x) { return cylinderPhi(x, 1, 3); },
       {-2, -2, -1},
       {2, 2, 4}},
      {"sphere",
       test::sphere(2),
       [](const Vec3& x) { return spherePhi(x, 2); },
       {-3, -3, -3},
       {3, 3, 3}},
      {"torus",
       test::torus(3, 1),
       [](const Vec3& x) { return torusPhi(x, 3, 1); },
       {-5, -5, -2},
       {5, 5, 2}},
  };
}

TEST(TrueDistance, AnalyticSolidsToRoundOff) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const TrueDistance distance = exactDistance(c.shape, 0.01);
    int inside = 0;
    int outside = 0;
    for (const Vec3& x : randomPoints(1000, c.low, c.high)) {
      const double expected = c.phi(x);
      EXPECT_NEAR(distance.signedDistance(x), expected, 1e-9) << x.transpose();
      const TrueDistance::Foot foot = distance.foot(x);
      EXPECT_NEAR((foot.point - x).norm(), foot.distance, 1e-12);
      EXPECT_NEAR(c.phi(foot.point), 0, 1e-9);
      ++(expected < 0 ? inside : outside);
    }
    EXPECT_GT(inside, 50);
    EXPECT_GT(outside, 50);
  }
}

TEST(TrueDistance, SignHoldsBetweenTrianglesAndSurface) {
  // Points nearer to the sphere than the chordal error, on both sides.
  const double deflection = 0.05;
  const TrueDistance distance = exactDistance(test::sphere(1), deflection);
  for (Vec3 x : randomPoints(300, {-1, -1, -1}, {1, 1, 1})) {
    if (x.norm() < 0.1) continue;
    for (const double offset : {-1e-3, 1e-3}) {
      const Vec3 p = (1 + offset) * x.normalized();
      EXPECT_NEAR(distance.signedDistance(p), offset, 1e-9);
    }
  }
}

TEST(TrueDistance, FeaturesFollowTheTrimmedDomain) {
  const TrueDistance distance = exactDistance(test::box(1, 2, 3), 0.01);
  EXPECT_EQ(distance.foot({0.5, 1, 4}).feature.kind, FeatureKind::Face);
  EXPECT_EQ(distance.foot({2, 1, 4}).feature.kind, FeatureKind::Edge);
  EXPECT_EQ(distance.foot({2, 3, 4}).feature.kind, FeatureKind::Vertex);
  const auto face = distance.foot({0.5, 1, 4}).feature.id;
  const auto& plane = distance.tessellation().features.faces[static_cast<std::size_t>(face)].plane;
  ASSERT_TRUE(plane);
  EXPECT_NEAR(plane->offset, 3, 1e-12);
  EXPECT_NEAR(plane->normal.z(), 1, 1e-12);
  // Rim of a cylinder from outside: between the triangles' chords and the circle.
  const TrueDistance round = exactDistance(test::cylinder(1, 3), 0.01);
  for (int i = 0; i < 50; ++i) {
    const double u = 0.1 + i;
    const auto foot = round.foot({1.001 * std::cos(u), 1.001 * std::sin(u), 3.5});
    EXPECT_EQ(foot.feature.kind, FeatureKind::Edge);
    EXPECT_NEAR(foot.distance, std::hypot(0.001, 0.5), 1e-9);
    const auto below = round.foot({0.999 * std::cos(u), 0.999 * std::sin(u), 3.5});
    EXPECT_EQ(below.feature.kind, FeatureKind::Face);
    EXPECT_NEAR(below.distance, 0.5, 1e-9);
  }
}

TEST(TrueDistance, ConeApexIsAVertex) {
  const TrueDistance distance = exactDistance(test::cone(1, 2), 0.005);
  const auto above = distance.foot({0.01, 0, 2.5});
  EXPECT_EQ(above.feature.kind, FeatureKind::Vertex);
  EXPECT_NEAR(above.distance, std::hypot(0.01, 0.5), 1e-9);
  EXPECT_EQ(above.sign, 1);
  // Off the slope: the plane through the generator.
  const Vec3 normal = Vec3(2, 0, 1).normalized();
  const Vec3 onSlope(0.5, 0, 1);
  for (const double d : {-0.2, 0.3}) {
    EXPECT_NEAR(distance.signedDistance(onSlope + d * normal), d, 1e-9);
  }
}

// OpenCASCADE looks for the foot on one side of the axis only: on the wrong one for points beyond
// the apex of a cone, and for the part of a torus that lies across its axis.
TEST(TrueDistance, FeetOnBothSidesOfAnAxis) {
  const TrueDistance cone = exactDistance(test::cone(2, 1), 0.005);
  const Vec3 slope = Vec3(1, 0, 2).normalized();
  for (const double d : {0.3, 1.0}) {
    const auto foot = cone.foot(Vec3(0.1, 0, 0.95) + d * slope);
    EXPECT_NEAR(foot.distance, d, 1e-9);
    EXPECT_NEAR((foot.point - Vec3(0.1, 0, 0.95)).norm(), 0, 1e-6);
  }
  // Inside a cone the foot is on the base or on the point's own side of the slope.
  const TrueDistance tall = exactDistance(test::cone(5, 12), 0.02);
  for (const Vec3& x : randomPoints(400, {-4, -4, 0}, {4, 4, 12})) {
    const double depth = std::min(x[2], (5 * (1 - x[2] / 12) - x.head<2>().norm()) * 12 / 13);
    if (depth > 0) {
      EXPECT_NEAR(tall.signedDistance(x), -depth, 1e-9) << x.transpose();
    }
  }
  const Handle(Geom_ToroidalSurface) spindle = new Geom_ToroidalSurface(gp_Ax3(), 1, 3);
  const TopoDS_Face barrel =
      BRepBuilderAPI_MakeFace(spindle, 0, 2 * std::numbers::pi, 2.2, 4.0, 1e-7).Face();
  const TrueDistance inner = exactDistance(barrel, 0.005, BodyKind::Sheet);
  for (const double u : {0.3, 2.0, 5.0}) {
    for (const double v : {2.5, 3.3, 3.8}) {
      const gp_Pnt p = spindle->Value(u, v);
      // The middle of the tube's circle lies across the axis.
      const Vec3 middle(std::cos(u), std::sin(u), 0);
      const Vec3 at(p.X(), p.Y(), p.Z());
      for (const double d : {0.5, -0.5}) {
        const auto foot = inner.foot(at + d * (at - middle).normalized());
        EXPECT_NEAR(foot.distance, 0.5, 1e-9) << u << " " << v << " " << d;
      }
    }
  }
}

TEST(TrueDistance, SmoothEdgesAreFaces) {
  const TrueDistance distance = exactDistance(test::filletedBox(4, 0.5), 0.005);
  int faces = 0;
  for (const Vec3& x : randomPoints(500, {-1, -1, -1}, {5, 5, 5})) {
    const auto foot = distance.foot(x);
    faces += foot.feature.kind == FeatureKind::Face;
    // A rounded box: distance to the inner box less the radius. Inside that box the faces count.
    const Vec3 q = (x - Vec3::Constant(2)).cwiseAbs() - Vec3::Constant(1.5);
    const double expected = q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - 0.5;
    EXPECT_NEAR(foot.sign * foot.distance, expected, 1e-6) << x.transpose();  // fillet tolerance
  }
  EXPECT_EQ(faces, 500);
}

TEST(TrueDistance, FreeformFeetAreOrthogonal) {
  const TrueDistance distance = exactDistance(test::loft(), 0.002);
  int checked = 0;
  for (const Vec3& x : randomPoints(400, {-3, -3, 0.5}, {3, 3, 5.5})) {
    const auto foot = distance.foot(x);
    EXPECT_NEAR(foot.distance, foot.meshDistance, 0.01);
    if (foot.feature.kind != FeatureKind::Face || foot.distance < 0.05) continue;
    const auto mesh = distance.surface().foot(x);
    Vec3 point, normal;
    if (mesh.triangle == kNone ||
        distance.tessellation().mesh.faceOf[static_cast<std::size_t>(mesh.triangle)] !=
            foot.feature.id ||
        !distance.pointAndNormal(mesh.triangle, mesh.barycentric, point, normal)) {
      continue;
    }
    EXPECT_GT(std::abs(normal.dot((x - foot.point) / foot.distance)), 1 - 1e-2);
    ++checked;
  }
  EXPECT_GT(checked, 50);
}

TEST(TrueDistance, FeetConvergeBeyondCentresOfCurvature) {
  // z = 0.8 x^2 + 0.4 y^2 as a Bezier patch over sheared parameters: x = u + 0.4 v, y = v. Seen
  // from beyond a centre of curvature the distance has a saddle at the foot that one starts beside.
  TColgp_Array2OfPnt poles(1, 3, 1, 3);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double u = 2 * i - 2.0;
      const double v = 2 * j - 2.0;
      const double uu = i == 1 ? -4 : 4;
      const double vv = j == 1 ? -4 : 4;
      poles.SetValue(i + 1, j + 1,
                     gp_Pnt(u + 0.4 * v, v, 0.8 * (uu + 0.8 * u * v + 0.16 * vv) + 0.4 * vv));
    }
  }
  const Handle(Geom_BezierSurface) patch = new Geom_BezierSurface(poles);
  const FaceSurface surface(BRepBuilderAPI_MakeFace(patch, 1e-7).Face());
  for (const Vec3& p : randomPoints(300, {-0.3, -0.3, 0.4}, {0.3, 0.3, 1.4})) {
    const Eigen::Vector2d uv(0.5 + 0.25 * p[0], 0.5 + 0.25 * p[1]);
    Vec3 on;
    Vec3 normal;
    ASSERT_TRUE(surface.pointAndNormal(uv, on, normal));
    if (normal[2] < 0) normal = -normal;
    const Vec3 query = on + p[2] * normal;
    const Eigen::Vector2d beside = uv + Eigen::Vector2d(0.003, -0.002);
    const SurfaceFoot foot = surface.foot(query, 1e-9, beside);
    EXPECT_TRUE(foot.converged) << query.transpose();
    EXPECT_LE((foot.point - query).norm(), p[2] + 1e-9);
  }
}

TEST(TrueDistance, FeetOnOffsetSurfacesAreFound) {
  TColgp_Array2OfPnt poles(1, 4, 1, 4);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      poles.SetValue(i + 1, j + 1, gp_Pnt(i, j, i % 3 == 0 || j % 3 == 0 ? 0 : 0.8));
  const Handle(Geom_Surface) basis = new Geom_BezierSurface(poles);
  gp_Trsf mirror;
  mirror.SetMirror(gp_Ax2(gp_Pnt(1, 2, 3), gp_Dir(1, 1, 0)));
  for (const double height : {0.3, -0.4}) {
    const TopoDS_Face face =
        BRepBuilderAPI_MakeFace(new Geom_OffsetSurface(basis, height), 1e-7).Face();
    for (const TopoDS_Shape& placed :
         {TopoDS_Shape(face), face.Moved(TopLoc_Location(mirror), Standard_False)}) {
      const FaceSurface surface(TopoDS::Face(placed));
      for (const Vec3& p : randomPoints(200, {0.1, 0.1, -0.2}, {0.9, 0.9, 0.2})) {
        const Eigen::Vector2d uv(p[0], p[1]);
        Vec3 on;
        Vec3 normal;
        ASSERT_TRUE(surface.pointAndNormal(uv, on, normal));
        const SurfaceFoot foot =
            surface.foot(on + p[2] * normal, 1e-10, uv + Eigen::Vector2d(0.05, -0.04));
        EXPECT_TRUE(foot.converged);
        EXPECT_NEAR((foot.point - on).norm(), 0, 1e-7);
      }
    }
  }
}

TEST(TrueDistance, PointAndNormalLieOnTheSurface) {
  const TrueDistance distance = exactDistance(test::sphere(2), 0.02);
  const auto count = static_cast<Index>(distance.tessellation().mesh.triangles.size());
  for (Index t = 0; t < count; ++t) {
    Vec3 point, normal;
    ASSERT_TRUE(distance.pointAndNormal(t, {0.2, 0.3, 0.5}, point, normal));
    EXPECT_NEAR(point.norm(), 2, 1e-12);
    EXPECT_NEAR((normal - point.normalized()).norm(), 0, 1e-9);
    // At a pole the surface has no normal; a point beside it does.
    for (int k = 0; k < 3; ++k) {
      ASSERT_TRUE(distance.pointAndNormal(t, Vec3::Unit(k), point, normal));
      EXPECT_NEAR((normal - point.normalized()).norm(), 0, 1e-6);
    }
  }
}

TEST(TrueDistance, RefusesATessellationOfAnotherShape) {
  auto mesh = tessellate(test::solidBody(test::box(1, 1, 1)), {.deflection = 0.1});
  ASSERT_TRUE(mesh);
  EXPECT_FALSE(TrueDistance::build(test::sphere(1), std::move(*mesh)));
}

/// The sheet (u^3 - u, u^2, 10 v), |u| <= 2, which crosses itself in the line x = 0, y = 1, without
/// its loop |u| < 1 at 0.1 < v < 0.9: there two of its borders lie on one another.
TopoDS_Face sheetWithoutLoop() {
  TColgp_Array2OfPnt poles(1, 4, 1, 2);
  const std::array<Eigen::Vector2d, 4> profile{
      Eigen::Vector2d(-6, 4), {8 + 2.0 / 3, -4.0 / 3}, {-8 - 2.0 / 3, -4.0 / 3}, {6, 4}};
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d& p = profile[static_cast<std::size_t>(i)];
    for (int j = 0; j < 2; ++j) poles(i + 1, j + 1) = gp_Pnt(p.x(), p.y(), 10 * j);
  }
  const Handle(Geom_Surface) surface = new Geom_BezierSurface(poles);
  const std::array<gp_Pnt2d, 4> corners{gp_Pnt2d(0.25, 0.1), {0.25, 0.9}, {0.75, 0.9}, {0.75, 0.1}};
  BRepBuilderAPI_MakeWire hole;
  for (std::size_t i = 0; i < 4; ++i) {
    const gp_Pnt2d& from = corners[i];
    const gp_Pnt2d& to = corners[(i + 1) % 4];
    hole.Add(BRepBuilderAPI_MakeEdge(GCE2d_MakeSegment(from, to).Value(), surface).Edge());
  }
  BRepBuilderAPI_MakeFace face(surface, 1e-7);
  face.Add(hole.Wire());
  BRepLib::BuildCurves3d(face.Face());
  return face.Face();
}

TEST(TrueDistance, KnowsItsSheetWhereBordersLieOnOneAnother) {
  const TrueDistance distance = exactDistance(sheetWithoutLoop(), 0.3, BodyKind::Sheet);
  for (const double u : {-1.5, -1.2, -1.1, -1.02, 1.02, 1.1, 1.2, 1.5}) {
    for (const double z : {2.1, 4.7, 7.3}) {
      EXPECT_NEAR(distance.foot(Vec3(u * u * u - u, u * u, z)).distance, 0, 1e-7) << u << " " << z;
    }
  }
  // On the loop that is not there: as far as its sides.
  for (const double u : {-0.99, -0.97, 0.97, 0.99}) {
    const Vec3 x(u * u * u - u, u * u, 5);
    EXPECT_GT(distance.foot(x).distance, 0.2 * (x - Vec3(0, 1, 5)).norm()) << u;
  }
}

}  // namespace
}  // namespace phront::cad
