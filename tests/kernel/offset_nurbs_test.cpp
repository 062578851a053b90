// Control-point offsets against P + d n at the same parameter.
#include "phront/offset_nurbs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
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

/// Clamped, knots evenly spaced.
Knots uniform(int degree, std::size_t poles) {
  Knots knots{degree, {}};
  const std::size_t spans = poles - static_cast<std::size_t>(degree);
  knots.flat.assign(static_cast<std::size_t>(degree), 0);
  for (std::size_t k = 0; k <= spans; ++k)
    knots.flat.push_back(static_cast<double>(k) / static_cast<double>(spans));
  knots.flat.insert(knots.flat.end(), static_cast<std::size_t>(degree), 1);
  return knots;
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

TEST(OffsetNurbsCurve, ReversibleBoundsTheWayBack) {
  // |d| is many times the ripple's length, so that small errors tilt the normals enough.
  NurbsCurve curve{uniform(3, 40), {}, {}};
  for (std::size_t i = 0; i < 40; ++i) {
    const double t = curve.knots.greville()[i];
    curve.poles.emplace_back(20 * t, 0.02 * std::sin(60 * t), 0);
  }
  constexpr double kTolerance = 2e-4;
  for (const KnotRule rule : {KnotRule::Original, KnotRule::Fewest}) {
    NurbsOffsetOptions options{.distance = 3, .tolerance = kTolerance, .knots = rule};
    const auto missedBy = [&] {
      const auto there = offsetNurbs(curve, normalInPlane(curve, Vec3::UnitZ()), options);
      EXPECT_TRUE(there.has_value()) << there.error().message;
      EXPECT_LE(there->error, kTolerance);
      return farthest(there->curve, [&](double t) {
        const Vec3 n = normalInPlane(there->curve, Vec3::UnitZ())(t);
        // What an exact offset back from here would miss.
        return Vec3(evaluate(curve, t).position + options.distance * n);
      });
    };
    EXPECT_GT(missedBy(), 2 * kTolerance) << "the case asks nothing";
    options.reversible = true;
    EXPECT_LE(missedBy(), kTolerance * 1.001);
  }
}

TEST(OffsetNurbsCurve, ClosedCurveStaysClosed) {
  // Smooth at its seam, three lobes.
  constexpr std::size_t kPoles = 24;
  NurbsCurve curve{uniform(3, kPoles), {}, {}};
  for (std::size_t i = 0; i < kPoles; ++i) {
    const double t = 2 * std::numbers::pi * curve.knots.greville()[i];
    const double r = 2 + 0.3 * std::cos(3 * t);
    curve.poles.emplace_back(r * std::cos(t), r * std::sin(t), 0);
  }
  // The tangents at both ends of the seam are parallel.
  curve.poles[1][0] = curve.poles[kPoles - 2][0] = curve.poles[0][0];
  for (const double d : {0.3, -0.3}) {
    const CurveOffset offset = planar(curve, d, 1e-5);
    const Vec3 first = evaluate(offset.curve, 0).position;
    const Vec3 last = evaluate(offset.curve, 1).position;
    EXPECT_NEAR((first - last).norm(), 0, 1e-12);
  }
}

TEST(OffsetNurbsCurve, FewestKnotsForATolerance) {
  // 60 poles of a wave that needs far fewer.
  NurbsCurve curve{uniform(3, 60), {}, {}};
  for (const double t : curve.knots.greville()) curve.poles.emplace_back(6 * t, std::sin(6 * t), 0);
  std::size_t before = 0;
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    const auto offset =
        offsetNurbs(curve, normalInPlane(curve, Vec3::UnitZ()),
                    {.distance = 0.2, .tolerance = tolerance, .knots = KnotRule::Fewest});
    ASSERT_TRUE(offset.has_value()) << offset.error().message;
    EXPECT_LE(offset->error, tolerance);
    EXPECT_LE(
        farthest(offset->curve,
                 [&](double t) {
                   const CurvePoint p = evaluate(curve, t);
                   return Vec3(p.position + 0.2 * p.tangent.cross(Vec3::UnitZ()).normalized());
                 }),
        tolerance);
    EXPECT_LT(offset->curve.poles.size(), 25U);
    EXPECT_GE(offset->curve.poles.size(), before);
    before = offset->curve.poles.size();
  }
}

TEST(OffsetNurbsCurve, FitsAnyCurveAtItsParameter) {
  const auto spiral = [](double t) { return Vec3(t * std::cos(t), t * std::sin(t), 0.3 * t); };
  Knots knots{5, std::vector<double>(6, 1.0)};
  knots.flat.insert(knots.flat.end(), 6, 9.0);
  const auto fit = fitCurve(spiral, knots, {.tolerance = 1e-5, .knots = KnotRule::Fewest});
  ASSERT_TRUE(fit.has_value()) << fit.error().message;
  EXPECT_LE(farthest(fit->curve, spiral), 1e-5);
  EXPECT_LT(fit->curve.poles.size(), 60U);
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

Vec3 exactAt(const NurbsSurface& s, double u, double v, double d) {
  const SurfacePoint p = evaluate(s, u, v);
  return p.position + d * p.alongU.cross(p.alongV).normalized();
}

NurbsSurface surfaceOver(Knots u, Knots v, const std::function<Vec3(double, double)>& pole) {
  NurbsSurface s{std::move(u), std::move(v), {}, {}};
  const std::vector<double> us = s.u.greville();
  const std::vector<double> vs = s.v.greville();
  for (const double y : vs) {
    for (const double x : us) s.poles.push_back(pole(x, y));
  }
  return s;
}

/// Once around a symmetric section (NACA 4-digit thickness, closed trailing edge), chord 1, from
/// the trailing edge over the lower side.
Vec3 section(double t, double thickness) {
  const double x = 0.5 * (1 + std::cos(2 * std::numbers::pi * t));
  const double y = 5 * thickness *
                   (0.2969 * std::sqrt(x) - 0.1260 * x - 0.3516 * x * x + 0.2843 * x * x * x -
                    0.1036 * x * x * x * x);
  return {x, t < 0.5 ? -y : y, 0};
}

/// Swept, tapered and twisted along z.
NurbsSurface wing(double twist) {
  return surfaceOver(uniform(3, 41), uniform(3, 9), [twist](double u, double v) {
    const Vec3 p = (1 - 0.4 * v) * (section(u, 0.12) - Vec3(0.25, 0, 0));
    const double a = twist * v;
    return Vec3(std::cos(a) * p[0] - std::sin(a) * p[1] + 0.5 * v,
                std::sin(a) * p[0] + std::cos(a) * p[1], 3 * v);
  });
}

void expectFollows(const SurfaceOffset& offset, const NurbsSurface& original, double d,
                   double tolerance) {
  EXPECT_TRUE(checkNurbs(offset.surface).has_value());
  EXPECT_EQ(offset.surface.u.first(), original.u.first());
  EXPECT_EQ(offset.surface.u.last(), original.u.last());
  EXPECT_EQ(offset.surface.v.first(), original.v.first());
  EXPECT_EQ(offset.surface.v.last(), original.v.last());
  const double found =
      farthest(offset.surface, [&](double u, double v) { return exactAt(original, u, v, d); });
  EXPECT_LE(found, tolerance);
  EXPECT_LE(found, offset.error * 1.05 + 1e-13) << "the error told is the largest there is";
}

TEST(OffsetNurbsSurface, RuledAndBilinearPatches) {
  // A saddle: the normals turn, so degree 1 needs many knots; a higher degree few.
  const NurbsSurface saddle = surfaceOver(uniform(1, 2), uniform(1, 2),
                                          [](double u, double v) { return Vec3(u, v, u * v); });
  const NurbsSurface ruled = surfaceOver(uniform(3, 7), uniform(1, 2), [](double u, double v) {
    return Vec3(u, v, 0.2 * std::sin(5 * u) * (1 - v) + 0.1 * std::cos(4 * u) * v);
  });
  for (const NurbsSurface& s : {saddle, ruled}) {
    const SurfaceOffset kept = moved(s, 0.1, 1e-4);
    expectFollows(kept, s, 0.1, 1e-4);
    const auto fewest =
        offsetNurbs(s, {.distance = 0.1, .tolerance = 1e-4, .knots = KnotRule::Fewest});
    ASSERT_TRUE(fewest.has_value()) << fewest.error().message;
    expectFollows(*fewest, s, 0.1, 1e-4);
    EXPECT_LT(fewest->surface.poles.size(), kept.surface.poles.size() / 2);
  }
}

TEST(OffsetNurbsSurface, WingAndBladeFaces) {
  for (const double twist : {0.1, 0.9}) {
    const NurbsSurface original = wing(twist);
    for (const double d : {0.01, -0.003}) {
      const double tolerance = 1e-2 * std::abs(d);
      const SurfaceOffset kept = moved(original, d, tolerance);
      expectFollows(kept, original, d, tolerance);
      // Every knot of the original is one of the offset.
      for (const double knot : original.u.distinct())
        EXPECT_TRUE(
            std::binary_search(kept.surface.u.flat.begin(), kept.surface.u.flat.end(), knot));
      const auto fewest =
          offsetNurbs(original, {.distance = d, .tolerance = tolerance, .knots = KnotRule::Fewest});
      ASSERT_TRUE(fewest.has_value()) << fewest.error().message;
      expectFollows(*fewest, original, d, tolerance);
      EXPECT_LE(fewest->surface.poles.size(), kept.surface.poles.size());
      EXPECT_LE(fewest->surface.poles.size(), original.poles.size());
      // Closed at the trailing edge up to the corner there, as P + d n is.
      EXPECT_LE((evaluate(fewest->surface, 0, 0.5).position - exactAt(original, 0, 0.5, d)).norm(),
                tolerance);
    }
  }
}

TEST(OffsetNurbsSurface, ThereAndBackIsWhereItBegan) {
  const NurbsSurface original = wing(0.4);
  constexpr double kDistance = -0.01;  // outwards
  constexpr double kTolerance = 1e-5;
  for (const KnotRule rule : {KnotRule::Original, KnotRule::Fewest}) {
    const auto there = offsetNurbs(
        original,
        {.distance = kDistance, .tolerance = kTolerance, .knots = rule, .reversible = true});
    ASSERT_TRUE(there.has_value()) << there.error().message;
    const auto back = offsetNurbs(there->surface,
                                  {.distance = -kDistance, .tolerance = kTolerance, .knots = rule});
    ASSERT_TRUE(back.has_value()) << back.error().message;
    // Normals of the approximation differ, too: by its error over a wavelength of it.
    EXPECT_LE(farthest(back->surface,
                       [&](double u, double v) { return evaluate(original, u, v).position; }),
              2 * kTolerance);
  }
}

TEST(OffsetNurbsSurface, FewestKnotsOfWhatIsFlatOrRound) {
  // A plane with far more poles than it needs.
  const NurbsSurface plane = surfaceOver(uniform(3, 12), uniform(2, 9),
                                         [](double u, double v) { return Vec3(2 * u, 3 * v, 1); });
  const auto flat =
      offsetNurbs(plane, {.distance = 0.5, .tolerance = 1e-3, .knots = KnotRule::Fewest});
  ASSERT_TRUE(flat.has_value()) << flat.error().message;
  EXPECT_EQ(flat->surface.poles.size(), 4U);
  EXPECT_LE(flat->error, 1e-10);
  // What is exact stays exact, however coarse the tolerance.
  const auto round = offsetNurbs(extruded(ellipse(2, 2), Vec3(0, 0, 5)),
                                 {.distance = 0.5, .tolerance = 0.1, .knots = KnotRule::Fewest});
  ASSERT_TRUE(round.has_value()) << round.error().message;
  EXPECT_EQ(round->surface.poles.size(), 18U);
  EXPECT_LE(round->error, 1e-10);
}

/// A tube of radius 1 about a line that comes back on itself; its middle row of poles is `aside`.
NurbsSurface foldedTube(double aside) {
  NurbsSurface tube = extruded(ellipse(1, 1), Vec3::Zero());
  tube.v = {2, {0, 0, 0, 1, 1, 1}};
  tube.poles.clear();
  tube.weights.clear();
  const NurbsCurve circle = ellipse(1, 1);
  for (const Vec3& shift : {Vec3(0, 0, 0), Vec3(aside, 0, 2), Vec3(0, 0, 0.5)}) {
    for (std::size_t i = 0; i < circle.poles.size(); ++i) {
      tube.poles.push_back(circle.poles[i] + shift);
      tube.weights.push_back(circle.weights[i]);
    }
  }
  return tube;
}

TEST(OffsetNurbsSurface, NormalsDoNotTurnOverWhereTheSurfaceFoldsBack) {
  // S_v changes its sign, the normal of the tube does not.
  const NurbsSurface tube = foldedTube(0);
  const auto offset = offsetNurbs(tube, {.distance = 0.25, .tolerance = 1e-6});
  ASSERT_TRUE(offset.has_value()) << offset.error().message;
  for (double v = 0; v <= 1; v += 0.05)
    EXPECT_NEAR(evaluate(offset->surface, 1.3, v).position.head<2>().norm(), 1.25, 1e-5) << v;
}

TEST(OffsetNurbsSurface, NormalsBesideAnAlmostFoldDoNotSwing) {
  // S_v does not quite vanish: where it is along the tube's normal, S_u x S_v turns over within a
  // millionth of the domain.
  const NurbsSurface tube = foldedTube(1e-6);
  const auto offset = offsetNurbs(tube, {.distance = 0.25, .tolerance = 1e-4});
  ASSERT_TRUE(offset.has_value()) << offset.error().message;
  EXPECT_LE(offset->surface.poles.size(), 2 * tube.poles.size());
  for (double u = 0; u <= 1; u += 0.05) {
    for (double v = 0; v <= 1; v += 0.05) {
      const Vec3 p = evaluate(offset->surface, 4 * u, v).position;
      EXPECT_NEAR(p.head<2>().norm(), 1.25, 2e-4) << u << ' ' << v;
    }
  }
}

TEST(OffsetNurbsSurface, EdgesAreFoundThatItRefuses) {
  // Two plates with a rounding far smaller than the tolerance between them, and one with a ridge.
  const auto profile = [](double bend) {
    NurbsCurve c;
    c.knots = {2, {0, 0, 0, 0.5, 0.5 + bend, 1, 1, 1}};
    c.poles = {{0, 0, 0}, {0.5, 0, 0}, {1 - 0.1 * bend, 0, 0}, {1, 0.5, 0}, {1, 1, 0}};
    return c;
  };
  const NurbsOffsetOptions options{.distance = 0.1, .tolerance = 1e-3};
  const EdgeStrips strip = edgeStrips(extruded(profile(1e-6), Vec3(0, 0, 1)), options);
  ASSERT_EQ(strip.u.size(), 1U);
  EXPECT_TRUE(strip.v.empty());
  EXPECT_NEAR(strip.u[0].low, 0.5, 1e-3);
  EXPECT_LE(strip.u[0].high - strip.u[0].low, 1e-3);
  EXPECT_TRUE(edgeStrips(extruded(profile(0.2), Vec3(0, 0, 1)), options).u.empty());
  NurbsCurve ridge;
  ridge.knots = {1, {0, 0, 1, 2, 2}};
  ridge.poles = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  const EdgeStrips edge = edgeStrips(extruded(ridge, Vec3(0, 0, 1)), options);
  ASSERT_EQ(edge.u.size(), 1U);
  EXPECT_EQ(edge.u[0].low, 1);
  EXPECT_EQ(edge.u[0].high, 1);
}

TEST(OffsetNurbsSurface, SphereKeepsItsPoles) {
  const SurfaceOffset ball = moved(sphere(2), 0.5, 1e-9);
  EXPECT_EQ(ball.surface.poles.size(), 45U);
  // The degenerate edges stay points.
  for (std::size_t i = 1; i < 9; ++i)
    EXPECT_NEAR((ball.surface.poles[i] - ball.surface.poles[0]).norm(), 0, 1e-9);
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
