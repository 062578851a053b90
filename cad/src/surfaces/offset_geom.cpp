#include "surfaces/offset_geom.h"

#include <fmt/format.h>

#include <GeomAdaptor_Curve.hxx>
#include <GeomConvert.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_Circle.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Line.hxx>
#include <Geom_OffsetSurface.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Ax3.hxx>
#include <numbers>
#include <optional>

#include "exchange/guard.h"

namespace phront::cad {
namespace {

using Pieces = std::vector<OffsetPiece>;

constexpr int kSamples = 9;  // along a line or a circle whose normals are looked at
constexpr double kSameNormal = 1e-10;
constexpr double kVanished = 1e-9;    // of |d|: radius that is none
constexpr int kFittedDegree = 5;      // of curves that are no splines
constexpr double kDegenerate = 1e-9;  // |S_u x S_v| of the two lengths' product
constexpr double kBesideEnd = 1e-10;  // of a piece: there it has its own normal
constexpr double kIntoDomain = 1e-5;  // from where a degenerate normal is taken

Pieces exactPiece(const Handle(Geom_Surface) & surface, const ParameterBox& box) {
  return {OffsetPiece{surface, box, true, 0}};
}

/// What is left of an interval.
std::vector<Interval> between(const Interval& all, const std::vector<Interval>& strips) {
  std::vector<Interval> parts;
  double low = all.low;
  for (const Interval& strip : strips) {
    if (strip.low > low) parts.push_back({low, strip.low});
    low = strip.high;
  }
  if (all.high > low) parts.push_back({low, all.high});
  return parts;
}

// ---- planes, cylinders, cones, spheres, tori

Pieces offsetCone(const Geom_ConicalSurface& cone, const ParameterBox& box, double outward) {
  gp_Ax3 axes = cone.Position();
  const double angle = cone.SemiAngle();
  axes.SetLocation(
      axes.Location().Translated(gp_Vec(axes.Direction()) * (-outward * std::sin(angle))));
  const double radius = cone.RefRadius() + outward * std::cos(angle);
  if (radius >= 0) return exactPiece(new Geom_ConicalSurface(axes, angle, radius), box);
  // The same points from the other side of the axis.
  gp_Trsf half;
  half.SetRotation(axes.Axis(), std::numbers::pi);
  axes.Transform(half);
  return exactPiece(new Geom_ConicalSurface(axes, -angle, -radius), box);
}

/// Null for other surfaces.
std::optional<Pieces> offsetElementary(const Handle(Geom_Surface) & surface,
                                       const ParameterBox& box, double distance) {
  const Handle(Geom_ElementarySurface) elementary =
      Handle(Geom_ElementarySurface)::DownCast(surface);
  if (elementary.IsNull()) return std::nullopt;
  const gp_Ax3 axes = elementary->Position();
  // S_u x S_v points outwards (of a plane: along its axis) in right-handed systems.
  const double outward = axes.Direct() ? distance : -distance;
  const double least = kVanished * std::abs(distance);
  if (surface->IsKind(STANDARD_TYPE(Geom_Plane))) {
    gp_Ax3 moved = axes;
    moved.Translate(gp_Vec(axes.Direction()) * outward);
    return exactPiece(new Geom_Plane(moved), box);
  }
  if (const auto cylinder = Handle(Geom_CylindricalSurface)::DownCast(surface);
      !cylinder.IsNull()) {
    const double radius = cylinder->Radius() + outward;
    if (radius <= least) return Pieces();
    return exactPiece(new Geom_CylindricalSurface(axes, radius), box);
  }
  if (const auto cone = Handle(Geom_ConicalSurface)::DownCast(surface); !cone.IsNull())
    return offsetCone(*cone, box, outward);
  if (const auto sphere = Handle(Geom_SphericalSurface)::DownCast(surface); !sphere.IsNull()) {
    const double radius = sphere->Radius() + outward;
    if (radius <= least) return Pieces();
    return exactPiece(new Geom_SphericalSurface(axes, radius), box);
  }
  if (const auto torus = Handle(Geom_ToroidalSurface)::DownCast(surface); !torus.IsNull()) {
    const double radius = torus->MinorRadius() + outward;
    if (radius <= least) return Pieces();
    return exactPiece(new Geom_ToroidalSurface(axes, torus->MajorRadius(), radius), box);
  }
  return std::nullopt;
}

// ---- revolutions and extrusions: the curve that is swept is offset along the surface's normal

Vec3 vectorOf(const gp_XYZ& p) { return {p.X(), p.Y(), p.Z()}; }

Handle(Geom_Curve) untrimmed(Handle(Geom_Curve) curve) {
  while (curve->IsKind(STANDARD_TYPE(Geom_TrimmedCurve)))
    curve = Handle(Geom_TrimmedCurve)::DownCast(curve)->BasisCurve();
  return curve;
}

class SweptOffset {
 public:
  SweptOffset(const Geom_SweptSurface& surface, const ParameterBox& box,
              const NurbsOffsetOptions& options)
      : surface_(surface),
        box_(box),
        options_(options),
        revolved_(surface.IsKind(STANDARD_TYPE(Geom_SurfaceOfRevolution))),
        curve_(untrimmed(surface.BasisCurve())) {}

  Result<Pieces> run() const {
    if (const std::optional<Pieces> pieces = exact()) return *pieces;
    Handle(Geom_BSplineCurve) spline = Handle(Geom_BSplineCurve)::DownCast(curve_);
    if (curve_->IsKind(STANDARD_TYPE(Geom_BezierCurve)))
      spline = GeomConvert::CurveToBSplineCurve(curve_);
    if (spline.IsNull()) return fitted();
    const auto normalAt = [this](double t) { return normal(t); };
    Pieces pieces;
    const NurbsCurve whole = nurbsOf(*spline, along());
    for (const Interval& part : between(along(), cornerStrips(whole, normalAt, options_))) {
      // Normals of this piece at its ends, not of the neighbours.
      const auto inside = [&](double t) {
        const double least = kBesideEnd * (part.high - part.low);
        return normal(std::clamp(t, part.low + least, part.high - least));
      };
      const Result<CurveOffset> offset = offsetNurbs(nurbsOf(*spline, part), inside, options_);
      if (!offset) return tl::unexpected(offset.error());
      pieces.push_back(swept(geomOf(offset->curve), part, false, offset->error));
    }
    return pieces;
  }

 private:
  [[nodiscard]] const Interval& along() const { return revolved_ ? box_.v : box_.u; }

  /// Of the surface, on its curve; the limit from inside where it meets the axis.
  [[nodiscard]] Vec3 normal(double t) const {
    const auto cross = [this](double at) {
      gp_Pnt p;
      gp_Vec u;
      gp_Vec v;
      if (revolved_)
        surface_.D1(0, at, p, u, v);
      else
        surface_.D1(at, box_.v.low, p, u, v);
      const gp_Vec n = u.Crossed(v);
      const double size =
          std::max(u.Magnitude() * v.Magnitude(), kDegenerate * v.Magnitude() * p.XYZ().Modulus());
      return n.Magnitude() > kDegenerate * size ? vectorOf(n.XYZ()).normalized().eval()
                                                : Vec3::Zero().eval();
    };
    const Vec3 here = cross(t);
    if (here.norm() > 0) return here;
    const Interval part = along();
    const double step =
        std::copysign(kIntoDomain * (part.high - part.low), 0.5 * (part.low + part.high) - t);
    const Vec3 limit = 2 * cross(t + step) - cross(t + 2 * step);
    return limit.norm() > 0 ? limit.normalized() : Vec3::Zero();
  }

  [[nodiscard]] Vec3 offsetPoint(double t) const {
    return vectorOf(curve_->Value(t).XYZ()) + options_.distance * normal(t);
  }

  /// Lines and circles whose offset is one.
  [[nodiscard]] std::optional<Pieces> exact() const {
    std::vector<double> samples;
    for (int i = 0; i < kSamples; ++i)
      samples.push_back(along().low + (along().high - along().low) * i / (kSamples - 1));
    if (const auto line = Handle(Geom_Line)::DownCast(curve_); !line.IsNull()) {
      const Vec3 n = normal(samples.front());
      for (const double t : samples)
        if (!((normal(t) - n).norm() <= kSameNormal)) return std::nullopt;
      const Handle(Geom_Curve) moved = Handle(Geom_Curve)::DownCast(
          line->Translated(gp_Vec(n[0], n[1], n[2]) * options_.distance));
      return Pieces{swept(moved, along(), true, 0)};
    }
    if (const auto circle = Handle(Geom_Circle)::DownCast(curve_); !circle.IsNull()) {
      const Vec3 centre = vectorOf(circle->Location().XYZ());
      const auto radial = [&](double t) {
        return Vec3((vectorOf(circle->Value(t).XYZ()) - centre) / circle->Radius());
      };
      const double side = std::copysign(1, normal(samples.front()).dot(radial(samples.front())));
      for (const double t : samples)
        if (!((normal(t) - side * radial(t)).norm() <= kSameNormal)) return std::nullopt;
      const double radius = circle->Radius() + side * options_.distance;
      if (radius <= kVanished * std::abs(options_.distance)) return Pieces();
      return Pieces{swept(new Geom_Circle(circle->Position(), radius), along(), true, 0)};
    }
    return std::nullopt;
  }

  /// A curve that is no spline.
  Result<Pieces> fitted() const {
    const GeomAdaptor_Curve adaptor(curve_, along().low, along().high);
    TColStd_Array1OfReal ends(1, adaptor.NbIntervals(GeomAbs_C2) + 1);
    adaptor.Intervals(ends, GeomAbs_C2);
    Knots knots{kFittedDegree, {}};
    for (int i = ends.Lower(); i <= ends.Upper(); ++i) {
      const bool inner = i > ends.Lower() && i < ends.Upper();
      // Twice differentiable there, at least.
      knots.flat.insert(knots.flat.end(), inner ? kFittedDegree - 2 : kFittedDegree + 1, ends(i));
    }
    const Result<CurveOffset> offset =
        fitCurve([this](double t) { return offsetPoint(t); }, knots, options_);
    if (!offset) return tl::unexpected(offset.error());
    return Pieces{swept(geomOf(offset->curve), along(), false, offset->error)};
  }

  [[nodiscard]] OffsetPiece swept(const Handle(Geom_Curve) & curve, const Interval& part,
                                  bool exact, double error) const {
    ParameterBox box = box_;
    (revolved_ ? box.v : box.u) = part;
    Handle(Geom_Surface) surface;
    if (revolved_) {
      const auto& from = static_cast<const Geom_SurfaceOfRevolution&>(surface_);
      surface = new Geom_SurfaceOfRevolution(curve, from.Axis());
    } else {
      surface = new Geom_SurfaceOfLinearExtrusion(curve, surface_.Direction());
    }
    return {surface, box, exact, error};
  }

  const Geom_SweptSurface& surface_;
  const ParameterBox& box_;
  const NurbsOffsetOptions& options_;
  bool revolved_;
  Handle(Geom_Curve) curve_;
};

// ---- B-splines

/// A piece may show an edge that the whole did not: cut again, so often.
constexpr int kMostCuts = 8;

Result<Pieces> offsetSpline(const Geom_BSplineSurface& surface, const ParameterBox& box,
                            const NurbsOffsetOptions& options, int cuts = 0) {
  const NurbsSurface part = nurbsOf(surface, box);
  const EdgeStrips edges = edgeStrips(part, options);
  if ((edges.u.empty() && edges.v.empty()) || cuts == kMostCuts) {
    const Result<SurfaceOffset> offset = offsetNurbs(part, options);
    if (!offset) return tl::unexpected(offset.error());
    return Pieces{{geomOf(offset->surface), box, false, offset->error}};
  }
  Pieces pieces;
  for (const Interval& v : between(box.v, edges.v)) {
    for (const Interval& u : between(box.u, edges.u)) {
      Result<Pieces> more = offsetSpline(surface, {u, v}, options, cuts + 1);
      if (!more) return more;
      pieces.insert(pieces.end(), more->begin(), more->end());
    }
  }
  return pieces;
}

Result<Pieces> offsetAny(const Handle(Geom_Surface) & surface, const ParameterBox& box,
                         const NurbsOffsetOptions& options) {
  if (const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface);
      !trimmed.IsNull())
    return offsetAny(trimmed->BasisSurface(), box, options);
  if (const auto offset = Handle(Geom_OffsetSurface)::DownCast(surface); !offset.IsNull()) {
    NurbsOffsetOptions both = options;
    both.distance += offset->Offset();
    return offsetAny(offset->BasisSurface(), box, both);
  }
  if (std::optional<Pieces> pieces = offsetElementary(surface, box, options.distance))
    return std::move(*pieces);
  if (const auto swept = Handle(Geom_SweptSurface)::DownCast(surface); !swept.IsNull())
    return SweptOffset(*swept, box, options).run();
  if (const auto spline = Handle(Geom_BSplineSurface)::DownCast(surface); !spline.IsNull())
    return offsetSpline(*spline, box, options);
  if (surface->IsKind(STANDARD_TYPE(Geom_BezierSurface)))
    return offsetSpline(*GeomConvert::SurfaceToBSplineSurface(surface), box, options);
  return fail(ErrorCode::NotSupported, fmt::format("surfaces of type {} have no offset here",
                                                   surface->DynamicType()->Name()));
}

}  // namespace

Result<std::vector<OffsetPiece>> offsetGeom(const Handle(Geom_Surface) & surface,
                                            const ParameterBox& box,
                                            const NurbsOffsetOptions& options) {
  return guardOcct("offsetting a surface", [&] { return offsetAny(surface, box, options); });
}

}  // namespace phront::cad
