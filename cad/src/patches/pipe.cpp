// A point of the offset whose foot is inside a convex edge lies at |d| from it, in the wedge
// between the two face normals there: a piece of the pipe surface of radius |d| (Rossignac &
// Requicha 1986). Straight edges give cylinders, circles give tori (spindle_pipe.cpp), the rest
// swept surfaces (swept_pipe.cpp). The two long sides are the images of the edge in its faces, the
// short sides arcs about its ends.
#include "patches/pipe.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Line.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <cmath>
#include <gp_Ax3.hxx>
#include <gp_Lin.hxx>

namespace phront::cad {
namespace {

bool constantNormals(const EdgeInfo& info, double slack) {
  const EdgeSample& reference = info.samples.front();
  for (const EdgeSample& s : info.samples) {
    if ((s.n1 - reference.n1).Magnitude() > slack) return false;
    if ((s.n2 - reference.n2).Magnitude() > slack) return false;
  }
  return true;
}

TopoDS_Edge straightEdge(const gp_Lin& path, const gp_Vec& shift, double first, double last,
                         const TopoDS_Vertex& from, const TopoDS_Vertex& to) {
  const BRep_Builder builder;
  TopoDS_Edge edge;
  builder.MakeEdge(edge, new Geom_Line(path.Translated(shift)), Precision::Confusion());
  builder.Add(edge, from.Oriented(TopAbs_FORWARD));
  builder.Add(edge, to.Oriented(TopAbs_REVERSED));
  builder.Range(edge, first, last);
  return edge;
}

PatchSide arcSide(const TopoDS_Edge& arc, const TopoDS_Vertex& from, const gp_Pnt2d& a,
                  const gp_Pnt2d& b) {
  const bool same = TopExp::FirstVertex(arc).IsSame(from);
  return {arc, same ? a : b, same ? b : a, false, {}};
}

}  // namespace

bool PipeFrame::runsAlong() const {
  const auto runs = [](const TopoDS_Edge& image, const TopoDS_Vertex& from,
                       const TopoDS_Vertex& to) {
    return !image.IsNull() && !from.IsNull() && !to.IsNull() &&
           TopExp::FirstVertex(image).IsSame(from) && TopExp::LastVertex(image).IsSame(to);
  };
  return runs(image1, first1, last1) && runs(image2, first2, last2);
}

std::optional<std::vector<TopoDS_Face>> linePipe(const PipeFrame& frame, ArcPool& arcs) {
  const EdgeInfo& info = *frame.info;
  const BRepAdaptor_Curve curve(info.edge);
  if (curve.GetType() != GeomAbs_Line) return std::nullopt;
  if (!constantNormals(info, frame.tolerance / frame.radius)) return std::nullopt;
  if (frame.first1.IsNull() || frame.first2.IsNull() || frame.last1.IsNull() ||
      frame.last2.IsNull()) {
    return std::nullopt;
  }
  const gp_Lin path = curve.Line();
  const EdgeSample& s = info.samples[info.samples.size() / 2];
  const gp_Vec along(path.Direction());
  const double turn = std::atan2(s.n1.Crossed(s.n2).Dot(along), s.n1.Dot(s.n2));
  // The axis turns n1 into n2; the seam lies opposite the middle of the patch.
  const gp_Vec axis = turn > 0 ? along : along.Reversed();
  const double sense = turn > 0 ? 1 : -1;
  const double half = std::abs(turn) / 2;
  const gp_Vec middle = s.n1 * std::cos(half) + axis.Crossed(s.n1) * std::sin(half);
  const gp_Ax3 position(path.Location(), gp_Dir(axis), gp_Dir(middle.Reversed()));
  const Handle(Geom_CylindricalSurface) surface =
      new Geom_CylindricalSurface(position, frame.radius);

  const double t0 = curve.FirstParameter();
  const double t1 = curve.LastParameter();
  const double u1 = M_PI - half;
  const double u2 = M_PI + half;
  const TopoDS_Edge long1 = frame.image1.IsNull() ? straightEdge(path, s.n1 * frame.radius, t0, t1,
                                                                 frame.first1, frame.last1)
                                                  : frame.image1;
  const TopoDS_Edge long2 = frame.image2.IsNull() ? straightEdge(path, s.n2 * frame.radius, t0, t1,
                                                                 frame.first2, frame.last2)
                                                  : frame.image2;
  const TopoDS_Edge arc0 =
      arcs.arc(curve.Value(t0), axis, frame.radius, frame.first1, frame.first2);
  const TopoDS_Edge arc1 = arcs.arc(curve.Value(t1), axis, frame.radius, frame.last1, frame.last2);
  const double v0 = sense * t0;
  const double v1 = sense * t1;
  const std::vector<PatchSide> sides{
      {long1, gp_Pnt2d(u1, v0), gp_Pnt2d(u1, v1), false, {}},
      arcSide(arc1, frame.last1, gp_Pnt2d(u1, v1), gp_Pnt2d(u2, v1)),
      {long2, gp_Pnt2d(u2, v0), gp_Pnt2d(u2, v1), false, {}},
      arcSide(arc0, frame.first1, gp_Pnt2d(u1, v0), gp_Pnt2d(u2, v0))};
  return std::vector<TopoDS_Face>{faceFromSides(surface, sides, Precision::Confusion())};
}

}  // namespace phront::cad
