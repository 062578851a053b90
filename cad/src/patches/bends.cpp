// A pipe of radius r folds where r k.n > 1 for the curvature k of the edge and a direction n of the
// section; k.n is largest at one of the two normals or, roughly, between them.
#include "patches/bends.h"

#include <algorithm>
#include <cmath>

namespace phront::cad {
namespace {

constexpr int kPlaces = 64;     // along an edge
constexpr int kWindow = 4;      // places to either side of a peak, and to the ends of the edge
constexpr double kPeak = 1.02;  // times what is at either end of the window

}  // namespace

std::optional<Bend> bendAt(const EdgeInfo& info, const BRepAdaptor_Curve& curve, double t) {
  const auto after = std::upper_bound(info.samples.begin() + 1, info.samples.end() - 1, t,
                                      [](double x, const EdgeSample& s) { return x < s.t; });
  const EdgeSample& a = *(after - 1);
  const EdgeSample& b = *after;
  const double between = std::clamp((t - a.t) / (b.t - a.t), 0.0, 1.0);
  const auto normal = [&](const gp_Vec& from, const gp_Vec& to) {
    return (from * (1 - between) + to * between).Normalized();
  };
  gp_Pnt p;
  gp_Vec d1;
  gp_Vec d2;
  curve.D2(t, p, d1, d2);
  if (d1.Magnitude() < 1e-12) return std::nullopt;
  const gp_Vec tangent = d1.Normalized();
  return Bend{normal(a.n1, b.n1), normal(a.n2, b.n2),
              (d2 - tangent * d2.Dot(tangent)) / d1.SquareMagnitude()};
}

std::vector<double> tightBends(const EdgeInfo& info, double radius) {
  const BRepAdaptor_Curve curve(info.edge);
  if (!info.pipe || info.samples.size() < 2 || curve.GetType() == GeomAbs_Line ||
      curve.GetType() == GeomAbs_Circle)
    return {};
  std::vector<double> bends;  // > 1: folded
  for (int i = 0; i <= kPlaces; ++i) {
    const double t =
        std::lerp(curve.FirstParameter(), curve.LastParameter(), static_cast<double>(i) / kPlaces);
    const std::optional<Bend> bend = bendAt(info, curve, t);
    if (!bend) return {};
    const gp_Vec middle = bend->n1 + bend->n2;
    double most = std::max(bend->curvature.Dot(bend->n1), bend->curvature.Dot(bend->n2));
    if (middle.Magnitude() > 1e-6) most = std::max(most, bend->curvature.Dot(middle.Normalized()));
    bends.push_back(radius * most);
  }
  std::vector<double> shares;
  for (int i = kWindow; i + kWindow <= kPlaces; ++i) {
    const double here = bends[static_cast<std::size_t>(i)];
    const auto first = bends.begin() + i - kWindow;
    const auto last = bends.begin() + i + kWindow;
    if (here > 1 && here >= *std::max_element(first, last + 1) && here > kPeak * *first &&
        here > kPeak * *last)
      shares.push_back(static_cast<double>(i) / kPlaces);
  }
  return shares;
}

}  // namespace phront::cad
