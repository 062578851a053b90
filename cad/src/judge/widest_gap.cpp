// A tolerance can close any hole: valid and closed say nothing where it is large. But fusing also
// leaves tolerances many times as large as what they bridge. Only places whose tolerance exceeds
// the widest gap found so far are measured.
#include "judge/widest_gap.h"

#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Pnt.hxx>

namespace phront::cad {
namespace {

constexpr int kSamples = 23;  // along an edge

class GapFinder {
 public:
  WidestGap find(const TopoDS_Shape& shape) {
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(shape, TopAbs_FACE, faces);
    for (int f = 1; f <= faces.Extent(); ++f) {
      const TopoDS_Face& face = TopoDS::Face(faces(f));
      for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next())
        look(TopoDS::Edge(e.Current()), face);
    }
    return gap_;
  }

 private:
  void note(double width, const gp_Pnt& at) {
    if (width <= gap_.width) return;
    gap_.width = width;
    gap_.at = Vec3(at.X(), at.Y(), at.Z());
  }

  static double largestTolerance(const TopoDS_Edge& edge) {
    double largest = BRep_Tool::Tolerance(edge);
    for (TopExp_Explorer v(edge, TopAbs_VERTEX); v.More(); v.Next())
      largest = std::max(largest, BRep_Tool::Tolerance(TopoDS::Vertex(v.Current())));
    return largest;
  }

  void look(const TopoDS_Edge& edge, const TopoDS_Face& face) {
    if (largestTolerance(edge) <= gap_.width) return;
    double first = 0;
    double last = 0;
    const Handle(Geom2d_Curve) onFace = BRep_Tool::CurveOnSurface(edge, face, first, last);
    if (onFace.IsNull()) return;  // BRepCheck has its say
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
    const auto pointOnFace = [&](double t) {
      const gp_Pnt2d uv = onFace->Value(t);
      return surface->Value(uv.X(), uv.Y());
    };
    for (TopExp_Explorer v(edge, TopAbs_VERTEX); v.More(); v.Next()) {
      const TopoDS_Vertex& vertex = TopoDS::Vertex(v.Current());
      const gp_Pnt at = BRep_Tool::Pnt(vertex);
      note(at.Distance(pointOnFace(BRep_Tool::Parameter(vertex, edge, face))), at);
    }
    if (BRep_Tool::Degenerated(edge)) return;
    double from = 0;
    double to = 0;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, from, to);
    if (curve.IsNull()) return;
    if (!BRep_Tool::SameParameter(edge) || from != first || to != last) {
      note(BRep_Tool::Tolerance(edge), curve->Value((from + to) / 2));
      return;
    }
    for (TopExp_Explorer v(edge, TopAbs_VERTEX); v.More(); v.Next()) {
      const TopoDS_Vertex& vertex = TopoDS::Vertex(v.Current());
      const gp_Pnt at = BRep_Tool::Pnt(vertex);
      note(at.Distance(curve->Value(BRep_Tool::Parameter(vertex, edge))), at);
    }
    for (int i = 0; i < kSamples; ++i) {
      const double t = std::lerp(from, to, static_cast<double>(i) / (kSamples - 1));
      const gp_Pnt at = curve->Value(t);
      note(at.Distance(pointOnFace(t)), at);
    }
  }

  WidestGap gap_;
};

}  // namespace

WidestGap widestGap(const TopoDS_Shape& shape) { return GapFinder().find(shape); }

}  // namespace phront::cad
