// The basis is OpenCASCADE's; sums over poles are written out, for poles live in plain vectors.
#include "phront/nurbs.h"

#include <fmt/format.h>

#include <BSplCLib.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <algorithm>
#include <cmath>
#include <math_Matrix.hxx>
#include <string_view>

#include "nurbs/basis.h"

namespace phront {
namespace {

Result<void> checkKnots(const Knots& knots, std::string_view name) {
  const auto order = static_cast<std::size_t>(knots.degree) + 1;
  if (knots.degree < 1 || knots.degree > kMaxDegree) {
    return fail(
        ErrorCode::InvalidArgument,
        fmt::format("The degree {} along {} is not in 1 .. {}.", knots.degree, name, kMaxDegree),
        "degree");
  }
  const bool finite = std::all_of(knots.flat.begin(), knots.flat.end(),
                                  [](double knot) { return std::isfinite(knot); });
  if (!finite || knots.flat.size() < 2 * order ||
      !std::is_sorted(knots.flat.begin(), knots.flat.end()) ||
      knots.flat.front() != knots.flat[order - 1] ||
      knots.flat.back() != knots.flat[knots.flat.size() - order] ||
      (knots.flat.size() > 2 * order &&
       (knots.flat[order] == knots.flat.front() ||
        knots.flat[knots.flat.size() - order - 1] == knots.flat.back())) ||
      !(knots.flat.front() < knots.flat.back())) {
    return fail(
        ErrorCode::InvalidArgument,
        fmt::format("The knots along {} must rise, the first and the last {} times.", name, order),
        "knots");
  }
  // Inner knots lie between the first and the last `order`.
  for (std::size_t k = order; k + order + knots.degree < knots.flat.size(); ++k) {
    if (knots.flat[k] != knots.flat[k + static_cast<std::size_t>(knots.degree)]) continue;
    return fail(ErrorCode::InvalidArgument,
                fmt::format("The inner knot {:g} along {} is there more often than the degree.",
                            knots.flat[k], name),
                "knots");
  }
  return {};
}

Result<void> checkPoles(const std::vector<Vec3>& poles, const std::vector<double>& weights,
                        std::size_t count) {
  if (poles.size() != count) {
    return fail(ErrorCode::InvalidArgument,
                fmt::format("The knots ask for {} poles, there are {}.", count, poles.size()),
                "poles");
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!poles[i].allFinite()) {
      return fail(ErrorCode::InvalidArgument, fmt::format("Pole {} is not finite.", i), "poles");
    }
  }
  if (weights.empty()) return {};
  if (weights.size() != count) {
    return fail(ErrorCode::InvalidArgument,
                fmt::format("{} poles need as many weights, there are {}.", count, weights.size()),
                "weights");
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!(weights[i] > 0) || !std::isfinite(weights[i])) {
      return fail(ErrorCode::InvalidArgument,
                  fmt::format("Weight {} is {:g}; weights are positive.", i, weights[i]),
                  "weights");
    }
  }
  return {};
}

using Homogeneous = Eigen::Vector4d;

Homogeneous lifted(const std::vector<Vec3>& poles, const std::vector<double>& weights,
                   std::size_t i) {
  const double w = weights.empty() ? 1 : weights[i];
  return {w * poles[i][0], w * poles[i][1], w * poles[i][2], w};
}

Vec3 projected(const Homogeneous& p) { return p.head<3>() / p[3]; }
/// Derivative of the projection of p along `slope`.
Vec3 projectedSlope(const Homogeneous& p, const Homogeneous& slope) {
  return (slope.head<3>() - slope[3] * projected(p)) / p[3];
}

}  // namespace

std::vector<double> Knots::distinct() const {
  std::vector<double> result = flat;
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

std::vector<double> Knots::greville() const {
  std::vector<double> result(poleCount());
  for (std::size_t i = 0; i < result.size(); ++i) {
    double sum = 0;
    for (int k = 1; k <= degree; ++k) sum += flat[i + static_cast<std::size_t>(k)];
    result[i] = std::clamp(sum / degree, first(), last());
  }
  return result;
}

Result<void> checkKnots(const Knots& knots) { return checkKnots(knots, "the curve"); }

Result<void> checkNurbs(const NurbsCurve& curve) {
  if (auto ok = checkKnots(curve.knots); !ok) return ok;
  return checkPoles(curve.poles, curve.weights, curve.knots.poleCount());
}

Result<void> checkNurbs(const NurbsSurface& surface) {
  if (auto ok = checkKnots(surface.u, "u"); !ok) return ok;
  if (auto ok = checkKnots(surface.v, "v"); !ok) return ok;
  return checkPoles(surface.poles, surface.weights, surface.u.poleCount() * surface.v.poleCount());
}

BasisAt basisAt(const Knots& knots, double t) {
  const int order = knots.degree + 1;
  const TColStd_Array1OfReal flat(knots.flat.front(), 1, static_cast<int>(knots.flat.size()));
  math_Matrix basis(1, 2, 1, order);
  int first = 0;
  BSplCLib::EvalBsplineBasis(1, order, flat, std::clamp(t, knots.first(), knots.last()), first,
                             basis);
  BasisAt result;
  result.first = static_cast<std::size_t>(first - 1);
  for (int k = 0; k < order; ++k) {
    result.value[static_cast<std::size_t>(k)] = basis(1, k + 1);
    result.slope[static_cast<std::size_t>(k)] = basis(2, k + 1);
  }
  return result;
}

CurvePoint evaluate(const NurbsCurve& curve, double t) {
  const BasisAt basis = basisAt(curve.knots, t);
  Homogeneous p = Homogeneous::Zero();
  Homogeneous slope = Homogeneous::Zero();
  for (std::size_t k = 0; k <= static_cast<std::size_t>(curve.knots.degree); ++k) {
    const Homogeneous pole = lifted(curve.poles, curve.weights, basis.first + k);
    p += basis.value[k] * pole;
    slope += basis.slope[k] * pole;
  }
  return {projected(p), projectedSlope(p, slope), p[3]};
}

SurfacePoint evaluate(const NurbsSurface& surface, double u, double v) {
  const BasisAt inU = basisAt(surface.u, u);
  const BasisAt inV = basisAt(surface.v, v);
  Homogeneous p = Homogeneous::Zero();
  Homogeneous alongU = Homogeneous::Zero();
  Homogeneous alongV = Homogeneous::Zero();
  for (std::size_t b = 0; b <= static_cast<std::size_t>(surface.v.degree); ++b) {
    Homogeneous row = Homogeneous::Zero();
    Homogeneous rowSlope = Homogeneous::Zero();
    for (std::size_t a = 0; a <= static_cast<std::size_t>(surface.u.degree); ++a) {
      const Homogeneous pole = lifted(surface.poles, surface.weights,
                                      inU.first + a + (inV.first + b) * surface.u.poleCount());
      row += inU.value[a] * pole;
      rowSlope += inU.slope[a] * pole;
    }
    p += inV.value[b] * row;
    alongU += inV.value[b] * rowSlope;
    alongV += inV.slope[b] * row;
  }
  return {projected(p), projectedSlope(p, alongU), projectedSlope(p, alongV), p[3]};
}

}  // namespace phront
