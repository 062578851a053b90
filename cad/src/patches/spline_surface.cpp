// OpenCASCADE evaluates an offset surface from its basis: second derivatives take third ones of the
// basis, one by one and uncached, some fifty times the cost of a spline's. Distances and
// intersections ask for little else; on some parts they take all of the time.
// Weak spot: a smooth edge then lies on its two faces within the tolerance only.
#include "patches/spline_surface.h"

#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <GeomConvert_ApproxSurface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_OffsetSurface.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Precision.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <optional>

namespace phront::cad {
namespace {

constexpr int kDegree = 5;
constexpr int kMaxPatches = 400;     // per surface: beyond, the spline is as slow
constexpr double kMargin = 0.02;     // of the face's parameter range, kept around it
constexpr double kMostOfTurn = 0.9;  // of a closed surface: a face on more of it may have a seam
constexpr double kSamples[] = {0.1, 0.35, 0.6, 0.85};  // in every span

struct Range {
  double first = 0;
  double last = 0;
};

/// The face's range with a margin, within the surface's. Empty where the face may have a seam.
std::optional<Range> rangeFor(Range face, Range surface, bool closed, bool periodic) {
  const double span = face.last - face.first;
  if (!(span > 0)) return std::nullopt;
  if (closed && span > kMostOfTurn * (surface.last - surface.first)) return std::nullopt;
  Range range{face.first - kMargin * span, face.last + kMargin * span};
  if (!periodic) {
    range.first = std::max(range.first, surface.first);
    range.last = std::min(range.last, surface.last);
  }
  return range;
}

bool isNear(const Geom_BSplineSurface& spline, const Geom_Surface& surface, double tolerance) {
  for (int i = 1; i < spline.NbUKnots(); ++i) {
    for (int j = 1; j < spline.NbVKnots(); ++j) {
      for (const double s : kSamples) {
        for (const double t : kSamples) {
          const double u = spline.UKnot(i) + s * (spline.UKnot(i + 1) - spline.UKnot(i));
          const double v = spline.VKnot(j) + t * (spline.VKnot(j + 1) - spline.VKnot(j));
          if (!(spline.Value(u, v).Distance(surface.Value(u, v)) <= tolerance)) return false;
        }
      }
    }
  }
  return true;
}

Handle(Geom_BSplineSurface) splineFor(const TopoDS_Face& face,
                                      const Handle(Geom_OffsetSurface) & offset, double tolerance) {
  Range ofFace[2];
  Range ofSurface[2];
  BRepTools::UVBounds(face, ofFace[0].first, ofFace[0].last, ofFace[1].first, ofFace[1].last);
  offset->Bounds(ofSurface[0].first, ofSurface[0].last, ofSurface[1].first, ofSurface[1].last);
  const auto u = rangeFor(ofFace[0], ofSurface[0], offset->IsUClosed(), offset->IsUPeriodic());
  const auto v = rangeFor(ofFace[1], ofSurface[1], offset->IsVClosed(), offset->IsVPeriodic());
  if (!u || !v) return nullptr;
  const Handle(Geom_RectangularTrimmedSurface) trimmed =
      new Geom_RectangularTrimmedSurface(offset, u->first, u->last, v->first, v->last);
  const GeomConvert_ApproxSurface approximation(trimmed, tolerance / 2, GeomAbs_C1, GeomAbs_C1,
                                                kDegree, kDegree, kMaxPatches, 0);
  if (!approximation.HasResult()) return nullptr;
  const Handle(Geom_BSplineSurface) spline = approximation.Surface();
  return isNear(*spline, *offset, tolerance) ? spline : nullptr;
}

/// The edge's curves in (u,v) on `from` move to `to`.
void moveCurves(const TopoDS_Edge& edge, const Handle(Geom_Surface) & from,
                const Handle(Geom_Surface) & to, const TopLoc_Location& location) {
  const BRep_Builder builder;
  const double tolerance = BRep_Tool::Tolerance(edge);
  double first = 0;
  double last = 0;
  const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, from, location, first, last);
  if (curve.IsNull()) return;
  builder.UpdateEdge(edge, curve, to, location, tolerance);
  builder.Range(edge, to, location, first, last);
  builder.UpdateEdge(edge, Handle(Geom2d_Curve)(), from, location, tolerance);
}

}  // namespace

bool useSpline(const TopoDS_Face& face, double tolerance) {
  TopLoc_Location location;
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face, location);
  const Handle(Geom_OffsetSurface) offset = Handle(Geom_OffsetSurface)::DownCast(surface);
  if (offset.IsNull()) return false;
  Handle(Geom_BSplineSurface) spline;
  try {
    spline = splineFor(face, offset, tolerance);
  } catch (const Standard_Failure&) {
    return false;
  }
  if (spline.IsNull()) return false;
  TopTools_IndexedMapOfShape edges;
  TopExp::MapShapes(face, TopAbs_EDGE, edges);
  for (int i = 1; i <= edges.Extent(); ++i) {
    if (BRep_Tool::IsClosed(TopoDS::Edge(edges(i)), surface, location)) return false;
  }
  for (int i = 1; i <= edges.Extent(); ++i)
    moveCurves(TopoDS::Edge(edges(i).Oriented(TopAbs_FORWARD)), surface, spline, location);
  BRep_Builder().UpdateFace(face, spline, location, BRep_Tool::Tolerance(face));
  return true;
}

}  // namespace phront::cad
