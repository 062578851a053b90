#include "surfaces/trimmed_offset.h"

#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_SweptSurface.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <optional>

#include "exchange/guard.h"
#include "surfaces/offset_geom.h"
#include "tessellate/face_surface.h"

namespace phront::cad {
namespace {

constexpr double kFitShare = 0.3;  // of the tolerance, for the surfaces

int polesOf(const Handle(Geom_Surface) & surface) {
  if (const auto spline = Handle(Geom_BSplineSurface)::DownCast(surface); !spline.IsNull())
    return spline->NbUPoles() * spline->NbVPoles();
  if (const auto bezier = Handle(Geom_BezierSurface)::DownCast(surface); !bezier.IsNull())
    return bezier->NbUPoles() * bezier->NbVPoles();
  const auto swept = Handle(Geom_SweptSurface)::DownCast(surface);
  if (swept.IsNull()) return 0;
  if (const auto spline = Handle(Geom_BSplineCurve)::DownCast(swept->BasisCurve());
      !spline.IsNull())
    return spline->NbPoles();
  if (const auto bezier = Handle(Geom_BezierCurve)::DownCast(swept->BasisCurve()); !bezier.IsNull())
    return bezier->NbPoles();
  return 0;
}

/// The face's parameters, kept to the surface's.
ParameterBox boxOf(const TopoDS_Face& face, const Geom_Surface& surface) {
  ParameterBox box;
  BRepTools::UVBounds(face, box.u.low, box.u.high, box.v.low, box.v.high);
  ParameterBox all;
  surface.Bounds(all.u.low, all.u.high, all.v.low, all.v.high);
  const auto kept = [](const Interval& part, const Interval& whole, bool periodic) {
    if (periodic) return part;
    return Interval{std::max(part.low, whole.low), std::min(part.high, whole.high)};
  };
  box.u = kept(box.u, all.u, surface.IsUPeriodic());
  box.v = kept(box.v, all.v, surface.IsVPeriodic());
  return box;
}

/// 1 when S_u x S_v of the surface points out of the face, -1 when into it.
std::optional<double> sideOf(const TopoDS_Face& face, const Geom_Surface& surface,
                             const ParameterBox& box) {
  const FaceSurface oriented(face);
  constexpr int kTries = 7;
  for (int i = 0; i < kTries; ++i) {
    const double share = (i + 1.0) / (kTries + 1);
    const Vec2 uv(box.u.low + share * (box.u.high - box.u.low),
                  box.v.low + (1 - share) * (box.v.high - box.v.low));
    Vec3 point;
    Vec3 normal;
    if (!oriented.pointAndNormal(uv, point, normal)) continue;
    gp_Pnt p;
    gp_Vec du;
    gp_Vec dv;
    surface.D1(uv[0], uv[1], p, du, dv);
    const double agreement = normal.dot(toVec3(du.Crossed(dv).XYZ()));
    if (agreement != 0) return std::copysign(1, agreement);
  }
  return std::nullopt;
}

Result<TrimmedOffset> offsetFaceOrFail(const TopoDS_Face& face, const TrimRequest& request,
                                       const TrueDistance& phi) {
  TrimmedOffset result;
  FaceOffset& report = result.report;
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
  if (surface.IsNull()) return fail(ErrorCode::Failed, "the face has no surface");
  report.type = FaceSurface(face).type();
  report.inputPoles = polesOf(surface);
  const ParameterBox box = boxOf(face, *surface);
  const std::optional<double> side = sideOf(face, *surface, box);
  if (!side) return fail(ErrorCode::Failed, "the face has no normal");
  const Result<std::vector<OffsetPiece>> pieces =
      offsetGeom(surface, box,
                 {.distance = *side * request.distance,
                  .tolerance = kFitShare * request.tolerance,
                  .knots = KnotRule::Fewest});
  if (!pieces) return tl::unexpected(pieces.error());
  bool exact = true;
  report.whole = !pieces->empty();
  for (const OffsetPiece& piece : *pieces) {
    exact = exact && piece.exact;
    report.poles += polesOf(piece.surface);
    report.fitError = std::max(report.fitError, piece.error);
    const bool cutAtBox = pieces->size() > 1 || piece.box.u.low > box.u.low ||
                          piece.box.u.high < box.u.high || piece.box.v.low > box.v.low ||
                          piece.box.v.high < box.v.high;
    const Result<TrimmedPiece> trimmed = trimPiece(face, piece, cutAtBox, request, phi);
    if (!trimmed) return tl::unexpected(trimmed.error());
    report.whole = report.whole && trimmed->whole;
    report.deviation = std::max(report.deviation, trimmed->deviation);
    for (const TopoDS_Face& part : trimmed->faces)
      result.faces.push_back(
          TopoDS::Face(part.Oriented(*side > 0 ? TopAbs_FORWARD : TopAbs_REVERSED)));
  }
  report.surfaces = static_cast<int>(result.faces.size());
  if (result.faces.empty())
    report.kind = FaceOffsetKind::Vanished;
  else
    report.kind = exact ? FaceOffsetKind::Exact : FaceOffsetKind::Fitted;
  return result;
}

}  // namespace

TrimmedOffset offsetTrimmedFace(const TopoDS_Face& face, const TrimRequest& request,
                                const TrueDistance& phi) {
  Result<TrimmedOffset> result =
      guardOcct("offsetting a face", [&] { return offsetFaceOrFail(face, request, phi); });
  if (result) return std::move(*result);
  TrimmedOffset failed;
  failed.report.trouble = result.error().message;
  return failed;
}

}  // namespace phront::cad
