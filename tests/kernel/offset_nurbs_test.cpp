// Control-point offsets against P + d n at the same parameter.
#include "phront/offset_nurbs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace phront {
namespace {

constexpr double kHalf = std::numbers::sqrt2 / 2;

NurbsCurve bezier(std::vector<Vec3> poles) {
  NurbsCurve curve;
  curve.knots.degree = static_cast<int>(poles.size()) - 1;
  curve.knots.flat.assign(poles.size(), 0);
  curve.knots.flat.insert(curve.knots.flat.end(), poles.size(), 1);
  curve.poles = std::move(poles);
  return curve;
}

/// Counter-clockwise about the z axis, four rational quadratic arcs; half axes a and b.
NurbsCurve ellipse(double a, double b) {
  NurbsCurve curve;
  curve.knots = {2, {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4}};
  curve.poles = {{a, 0, 0},   {a, b, 0},  {0, b, 0},  {-a, b, 0}, {-a, 0, 0},
                 {-a, -b, 0}, {0, -b, 0}, {a, -b, 0}, {a, 0, 0}};
  curve.weights = {1, kHalf, 1, kHalf, 1, kHalf, 1, kHalf, 1};
  return curve;
}

/// Sweeps a curve along a line.
NurbsSurface extruded(const NurbsCurve& curve, const Vec3& along) {
  NurbsSurface surface{curve.knots, {1, {0, 0, 1, 1}}, curve.poles, curve.weights};
  for (const Vec3& pole : curve.poles) surface.poles.push_back(pole + along);
  surface.weights.insert(surface.weights.end(), curve.weights.begin(), curve.weights.end());
  return surface;
}

/// Half circles of radius r from pole to pole about (R, 0), turned about the z axis: sphere (R =
/// 0).
NurbsSurface sphere(double r) {
  const NurbsCurve around = ellipse(1, 1);
  NurbsSurface surface;
  surface.u = around.knots;
  surface.v = {2, {0, 0, 0, 1, 1, 2, 2, 2}};
  const std::vector<Vec3> profile{{0, 0, -r}, {r, 0, -r}, {r, 0, 0}, {r, 0, r}, {0, 0, r}};
  const std::vector<double> weight{1, kHalf, 1, kHalf, 1};
  for (std::size_t j = 0; j < profile.size(); ++j) {
    for (std::size_t i = 0; i < around.poles.size(); ++i) {
      surface.poles.emplace_back(profile[j][0] * around.poles[i][0],
                                 profile[j][0] * around.poles[i][1], profile[j][2]);
      surface.weights.push_back(weight[j] * around.weights[i]);
    }
  }
  return surface;
}

NurbsSurface torus(double major, double minor) {
  const NurbsCurve around = ellipse(1, 1);
  const NurbsCurve tube = ellipse(minor, minor);
  NurbsSurface surface{around.knots, tube.knots, {}, {}};
  for (std::size_t j = 0; j < tube.poles.size(); ++j) {
    for (std::size_t i = 0; i < around.poles.size(); ++i) {
      const double radius = major + tube.poles[j][0];
      surface.poles.emplace_back(radius * around.poles[i][0], radius * around.poles[i][1],
                                 tube.poles[j][1]);
      surface.weights.push_back(tube.weights[j] * around.weights[i]);
    }
  }
  return surface;
}

/// Largest distance from the truth at many parameters that no pole belongs to.
template <class Truth>
double farthest(const NurbsCurve& curve, const Truth& truth) {
  double most = 0;
  for (int i = 0; i <= 997; ++i) {
    const double t = curve.knots.first() + (curve.knots.last() - curve.knots.first()) * i / 997;
    most = std::max(most, (evaluate(curve, t).position - truth(t)).norm());
  }
  return most;
}
template <class Truth>
double farthest(const NurbsSurface& s, const Truth& truth) {
  double most = 0;
  for (int i = 0; i <= 97; ++i) {
    for (int j = 0; j <= 97; ++j) {
      const double u = s.u.first() + (s.u.last() - s.u.first()) * i / 97;
      const double v = s.v.first() + (s.v.last() - s.v.first()) * j / 97;
      most = std::max(most, (evaluate(s, u, v).position - truth(u, v)).norm());
    }
  }
  return most;
}

CurveOffset planar(const NurbsCurve& curve, double distance, double tolerance) {
  const auto offset = offsetNurbs(curve, normalInPlane(curve, Vec3::UnitZ()),
                                  {.distance = distance, .tolerance = tolerance});
  EXPECT_TRUE(offset.has_value()) << offset.error().message;
  EXPECT_EQ(offset->curve.knots.degree, curve.knots.degree);
  EXPECT_TRUE(checkNurbs(offset->curve).has_value());
  const double found = farthest(offset->curve, [&](double t) {
    const CurvePoint p = evaluate(curve, t);
    return Vec3(p.position + distance * p.tangent.cross(Vec3::UnitZ()).normalized());
  });
  EXPECT_LE(offset->error, tolerance);
  EXPECT_LE(found, offset->error * 1.001 + 1e-13) << "the error told is the largest there is";
  return *offset;
}

SurfaceOffset moved(const NurbsSurface& surface, double distance, double tolerance) {
  const auto offset = offsetNurbs(surface, {.distance = distance, .tolerance = tolerance});
  EXPECT_TRUE(offset.has_value()) << offset.error().message;
  EXPECT_EQ(offset->surface.u.degree, surface.u.degree);
  EXPECT_EQ(offset->surface.v.degree, surface.v.degree);
  EXPECT_TRUE(checkNurbs(offset->surface).has_value());
  EXPECT_LE(offset->error, tolerance);
  return *offset;
}

TEST(OffsetNurbsCurve, LineMovesAlongItsNormal) {
  const CurveOffset offset = planar(bezier({{0, 0, 0}, {3, 4, 0}}), 2, 1e-12);
  ASSERT_EQ(offset.curve.poles.size(), 2U);
  EXPECT_EQ(offset.rule, PoleRule::Moved);
  EXPECT_NEAR((offset.curve.poles[0] - Vec3(1.6, -1.2, 0)).norm(), 0, 1e-15);
  EXPECT_NEAR((offset.curve.poles[1] - Vec3(4.6, 2.8, 0)).norm(), 0, 1e-15);
}

TEST(OffsetNurbsCurve, CircleStaysACircle) {
  for (const double d : {0.5, -0.5}) {
    const CurveOffset offset = planar(ellipse(2, 2), d, 1e-12);
    EXPECT_EQ(offset.curve.poles.size(), 9U);
    EXPECT_EQ(offset.curve.weights.size(), 9U);
    // The corner of the polygon moves by the square root of two times the distance.
    EXPECT_NEAR((offset.curve.poles[1] - Vec3(2 + d, 2 + d, 0)).norm(), 0, 1e-14);
  }
}

TEST(OffsetNurbsCurve, EllipseAddsKnotsForATolerance) {
  std::size_t before = 9;
  for (const double tolerance : {1e-3, 1e-5, 1e-7}) {
    const CurveOffset offset = planar(ellipse(3, 2), 0.4, tolerance);
    EXPECT_GT(offset.curve.poles.size(), before);
    before = offset.curve.poles.size();
  }
  EXPECT_LT(before, 500U);
}

TEST(OffsetNurbsCurve, CubicWithAnInflection) {
  const NurbsCurve curve = bezier({{0, 0, 0}, {1, 2, 0}, {2, -2, 0}, {3, 0, 0}});
  const std::size_t coarse = planar(curve, 0.1, 1e-3).curve.poles.size();
  const std::size_t fine = planar(curve, 0.1, 1e-6).curve.poles.size();
  EXPECT_LE(coarse, 16U);
  EXPECT_LE(fine, 64U);
  EXPECT_LT(coarse, fine);
}

TEST(OffsetNurbsCurve, FollowsACuspOfTheOffset) {
  // Curvature radius 1/2 at the bottom of the parabola, offset inwards by more.
  const NurbsCurve parabola = bezier({{-1, 1, 0}, {0, -1, 0}, {1, 1, 0}});
  const CurveOffset offset = planar(parabola, -0.8, 1e-4);
  EXPECT_LT(offset.curve.poles.size(), 200U);
}

TEST(OffsetNurbsCurve, ThereAndBackIsWhereItBegan) {
  const NurbsCurve curve = bezier({{0, 0, 0}, {1, 1.5, 0}, {2.5, 1, 0}, {3, 0, 0}});
  constexpr double kTolerance = 1e-5;
  const CurveOffset there = planar(curve, 0.2, kTolerance);
  const CurveOffset back = planar(there.curve, -0.2, kTolerance);
  EXPECT_LE(farthest(back.curve, [&](double t) { return evaluate(curve, t).position; }),
            2 * kTolerance);
}

TEST(OffsetNurbsCurve, AlongTheNormalOfASurface) {
  // A helix-like curve on a cylinder of radius 1 moves to the cylinder of radius 1.5.
  const NurbsCurve circle = ellipse(1, 1);
  const CurveNormal outward = [&](double t) {
    const Vec3 p = evaluate(circle, t).position;
    return Vec3(p[0], p[1], 0).normalized();
  };
  const auto offset = offsetNurbs(circle, outward, {.distance = 0.5, .tolerance = 1e-12});
  ASSERT_TRUE(offset.has_value()) << offset.error().message;
  EXPECT_LE(
      farthest(offset->curve, [&](double t) { return Vec3(1.5 * evaluate(circle, t).position); }),
      1e-12);
}

TEST(OffsetNurbsCurve, CornersAndBadNumbersAreRefused) {
  NurbsCurve corner;
  corner.knots = {1, {0, 0, 1, 2, 2}};
  corner.poles = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  const NurbsOffsetOptions options{.distance = 0.1, .tolerance = 1e-3};
  const auto refused = [&](const NurbsCurve& curve, const NurbsOffsetOptions& with) {
    const auto offset = offsetNurbs(curve, normalInPlane(curve, Vec3::UnitZ()), with);
    EXPECT_FALSE(offset.has_value());
    return offset ? std::string() : offset.error().message;
  };
  EXPECT_NE(refused(corner, options).find("corner at parameter 1"), std::string::npos);
  NurbsCurve line = bezier({{0, 0, 0}, {1, 0, 0}});
  EXPECT_NE(refused(line, {.distance = 0.1}).find("tolerance"), std::string::npos);
  EXPECT_NE(refused(line, {.distance = NAN, .tolerance = 1}).find("distance"), std::string::npos);
  line.weights = {1, 0};
  EXPECT_NE(refused(line, options).find("Weight 1"), std::string::npos);
  line.weights.clear();
  line.poles.pop_back();
  EXPECT_NE(refused(line, options).find("2 poles"), std::string::npos);
  line.knots.flat = {0, 0, 1, 0.5};
  EXPECT_NE(refused(line, options).find("knots"), std::string::npos);
  // Two poles in one place at the end: no tangent there.
  EXPECT_NE(refused(bezier({{0, 0, 0}, {1, 1, 0}, {2, 0, 0}, {2, 0, 0}}), options)
                .find("no normal at parameter 1"),
            std::string::npos);
  const NurbsCurve wave = bezier({{0, 0, 0}, {1, 2, 0}, {2, -2, 0}, {3, 0, 0}});
  EXPECT_NE(refused(wave, {.distance = 0.1, .tolerance = 1e-12, .maxPoles = 50}).find("50 poles"),
            std::string::npos);
}

TEST(OffsetNurbsSurface, BilinearPlaneIsExact) {
  const NurbsSurface plane = extruded(bezier({{0, 0, 0}, {2, 0, 0}}), Vec3(0, 3, 0));
  const SurfaceOffset offset = moved(plane, 0.25, 1e-12);
  EXPECT_EQ(offset.surface.poles.size(), 4U);
  EXPECT_EQ(offset.rule, PoleRule::Moved);
  for (const Vec3& pole : offset.surface.poles) EXPECT_NEAR(pole[2], 0.25, 1e-15);
}

TEST(OffsetNurbsSurface, RationalCylinderSphereAndTorusAreExact) {
  // Extruded counter-clockwise about z upwards: S_u x S_v points outwards.
  const SurfaceOffset cylinder = moved(extruded(ellipse(2, 2), Vec3(0, 0, 5)), 0.5, 1e-11);
  EXPECT_EQ(cylinder.surface.poles.size(), 18U);
  for (double u = 0; u < 4; u += 0.13)
    EXPECT_NEAR(evaluate(cylinder.surface, u, 0.3).position.head<2>().norm(), 2.5, 1e-12);
  const SurfaceOffset ball = moved(sphere(2), -0.5, 1e-5);
  EXPECT_EQ(ball.surface.poles.size(), 45U);
  const SurfaceOffset ring = moved(torus(3, 1), 0.5, 1e-11);
  EXPECT_EQ(ring.surface.poles.size(), 81U);
  for (double u = 0; u < 4; u += 0.13) {
    for (double v = 0; v < 4; v += 0.13) {
      EXPECT_NEAR(evaluate(ball.surface, u, v / 2).position.norm(), 1.5, 1e-5);
      const Vec3 p = evaluate(ring.surface, u, v).position;
      EXPECT_NEAR(std::hypot(p.head<2>().norm() - 3, p[2]), 1.5, 1e-12);
    }
  }
}

TEST(OffsetNurbsSurface, EdgesAndSurfacesThatAreNoneAreRefused) {
  const NurbsOffsetOptions options{.distance = 0.1, .tolerance = 1e-3};
  NurbsCurve corner;
  corner.knots = {1, {0, 0, 1, 2, 2}};
  corner.poles = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  const auto folded = offsetNurbs(extruded(corner, Vec3(0, 0, 1)), options);
  ASSERT_FALSE(folded.has_value());
  EXPECT_NE(folded.error().message.find("edge at u = 1"), std::string::npos);
  const auto flat = offsetNurbs(extruded(corner, Vec3::Zero()), options);
  ASSERT_FALSE(flat.has_value());
  EXPECT_NE(flat.error().message.find("no normal anywhere"), std::string::npos);
}

TEST(OffsetNurbsSurface, BicubicPatchKeepsTheTolerance) {
  NurbsSurface patch{{3, {0, 0, 0, 0, 1, 1, 1, 1}}, {3, {0, 0, 0, 0, 1, 1, 1, 1}}, {}, {}};
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i)
      patch.poles.emplace_back(i, j, 0.6 * std::sin(1.7 * i) * std::cos(1.3 * j));
  }
  std::size_t before = 0;
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    const SurfaceOffset offset = moved(patch, 0.2, tolerance);
    const double found = farthest(offset.surface, [&](double u, double v) {
      const SurfacePoint p = evaluate(patch, u, v);
      return Vec3(p.position + 0.2 * p.alongU.cross(p.alongV).normalized());
    });
    EXPECT_LE(found, tolerance);
    EXPECT_LE(found, offset.error * 1.05);
    EXPECT_GE(offset.surface.poles.size(), before);
    before = offset.surface.poles.size();
  }
  EXPECT_LT(before, 1000U);
}

}  // namespace
}  // namespace phront
