// Pipe round any edge. OpenCASCADE's own is intersected fastest, but often off by thousandths of
// |d|, which makes it look dead; then it is made here (swept_surface.h).
// Weak spot: where two normals are opposite, and at ends without images, OpenCASCADE's pipe stays
// however good it is.
#include <BRepBuilderAPI_Copy.hxx>
#include <BRepLib.hxx>
#include <BRepOffset_Offset.hxx>
#include <BRep_Tool.hxx>
#include <Precision.hxx>
#include <Standard_Failure.hxx>
#include <TopoDS.hxx>

#include "exchange/tolerances.h"
#include "patches/pipe.h"
#include "patches/swept_surface.h"

namespace phront::cad {
namespace {

/// OpenCASCADE's own.
TopoDS_Face plainPipe(const PipeFrame& frame, const TopoDS_Edge& first, const TopoDS_Edge& last) {
  const BRepOffset_Offset pipe(frame.info->edge, frame.image1, frame.image2, frame.radius, first,
                               last, Standard_False, frame.tolerance, GeomAbs_C1);
  TopoDS_Face face = pipe.Face();
  if (face.IsNull()) throw Standard_Failure("no pipe");
  BRepLib::BuildCurves3d(face, frame.tolerance);
  for (const TopoDS_Edge& edge : edgesOf(face)) raiseTolerance(edge, face);
  return face;
}

/// On copies of the sides: a pipe that is not used shall leave no trace on them.
bool plainIsGood(const PipeFrame& frame, const SweptSurface& pipe) {
  const auto copy = [](const TopoDS_Edge& edge) {
    return TopoDS::Edge(BRepBuilderAPI_Copy(edge, Standard_False).Shape());
  };
  try {
    const BRepOffset_Offset plain(frame.info->edge, copy(frame.image1), copy(frame.image2),
                                  frame.radius, TopoDS_Edge(), TopoDS_Edge(), Standard_False,
                                  frame.tolerance, GeomAbs_C1);
    if (plain.Face().IsNull()) return false;
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(plain.Face());
    return !surface.IsNull() && pipe.isMetBy(*surface);
  } catch (const Standard_Failure&) {
    return false;
  }
}

}  // namespace

TopoDS_Face sweptPipe(const PipeFrame& frame, ArcPool& arcs) {
  const EdgeInfo& info = *frame.info;
  const auto endArc = [&](const EdgeSample& s, const TopoDS_Vertex& v1, const TopoDS_Vertex& v2) {
    if (v1.IsNull() || v2.IsNull() || v1.IsSame(v2)) return TopoDS_Edge();
    return arcs.arc(s.point, s.axis(), frame.radius, v1, v2);
  };
  const TopoDS_Edge first = endArc(info.samples.front(), frame.first1, frame.first2);
  const TopoDS_Edge last = endArc(info.samples.back(), frame.last1, frame.last2);
  if (!frame.runsAlong()) return plainPipe(frame, first, last);
  const SweptSurface pipe(frame);
  if (!pipe.possible() || plainIsGood(frame, pipe)) return plainPipe(frame, first, last);
  const Handle(Geom_BSplineSurface) surface = pipe.make();
  if (surface.IsNull()) return plainPipe(frame, first, last);
  const double t0 = pipe.first();
  const double t1 = pipe.last();
  const std::vector<PatchSide> sides{{frame.image1, gp_Pnt2d(0, t0), gp_Pnt2d(0, t1), false, {}},
                                     pipe.shortSide(t1, last, frame.last1, 0, 1),
                                     {frame.image2, gp_Pnt2d(1, t0), gp_Pnt2d(1, t1), false, {}},
                                     pipe.shortSide(t0, first, frame.first1, 0, 1)};
  return faceFromSides(surface, sides, Precision::Confusion());
}

}  // namespace phront::cad
