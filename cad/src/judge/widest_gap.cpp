// A tolerance can close any hole: valid and closed say nothing where it is large. But fusing also
// leaves tolerances many times as large as what they bridge. Only places whose tolerance exceeds
// the limit are measured.
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
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Pnt.hxx>
#include <utility>

namespace phront::cad {
namespace {

constexpr int kSamples = 23;  // along an edge

class GapFinder {
 public:
  GapFinder(const TopoDS_Face& face, double limit)
      : face_(face), surface_(BRep_Tool::Surface(face)), limit_(limit) {}

  std::vector<FaceGap> find() {
    for (TopExp_Explorer e(face_, TopAbs_EDGE); e.More(); e.Next()) look(TopoDS::Edge(e.Current()));
    return std::move(gaps_);
  }

 private:
  void note(double width, const gp_Pnt& at, const gp_Pnt2d& onFace) {
    if (width > limit_) gaps_.push_back({onFace, width, Vec3(at.X(), at.Y(), at.Z())});
  }

  static double largestTolerance(const TopoDS_Edge& edge) {
    double largest = BRep_Tool::Tolerance(edge);
    for (TopExp_Explorer v(edge, TopAbs_VERTEX); v.More(); v.Next())
      largest = std::max(largest, BRep_Tool::Tolerance(TopoDS::Vertex(v.Current())));
    return largest;
  }

  void look(const TopoDS_Edge& edge) {
    if (largestTolerance(edge) <= limit_) return;
    double first = 0;
    double last = 0;
    const Handle(Geom2d_Curve) onFace = BRep_Tool::CurveOnSurface(edge, face_, first, last);
    if (onFace.IsNull()) return;  // BRepCheck has its say
    const auto compare = [&](const gp_Pnt& at, double t) {
      const gp_Pnt2d uv = onFace->Value(t);
      note(at.Distance(surface_->Value(uv.X(), uv.Y())), at, uv);
    };
    for (TopExp_Explorer v(edge, TopAbs_VERTEX); v.More(); v.Next()) {
      const TopoDS_Vertex& vertex = TopoDS::Vertex(v.Current());
      compare(BRep_Tool::Pnt(vertex), BRep_Tool::Parameter(vertex, edge, face_));
    }
    if (BRep_Tool::Degenerated(edge)) return;
    double from = 0;
    double to = 0;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, from, to);
    if (curve.IsNull()) return;
    if (!BRep_Tool::SameParameter(edge) || from != first || to != last) {
      note(BRep_Tool::Tolerance(edge), curve->Value((from + to) / 2),
           onFace->Value((first + last) / 2));
      return;
    }
    for (TopExp_Explorer v(edge, TopAbs_VERTEX); v.More(); v.Next()) {
      const TopoDS_Vertex& vertex = TopoDS::Vertex(v.Current());
      const gp_Pnt at = BRep_Tool::Pnt(vertex);
      const double t = BRep_Tool::Parameter(vertex, edge);
      note(at.Distance(curve->Value(t)), at, onFace->Value(t));
    }
    for (int i = 0; i < kSamples; ++i) {
      const double t = std::lerp(from, to, static_cast<double>(i) / (kSamples - 1));
      compare(curve->Value(t), t);
    }
  }

  const TopoDS_Face& face_;
  const Handle(Geom_Surface) surface_;
  const double limit_;
  std::vector<FaceGap> gaps_;
};

}  // namespace

std::vector<FaceGap> gapsOf(const TopoDS_Face& face, double limit) {
  return GapFinder(face, limit).find();
}

WidestGap widestGap(const TopoDS_Shape& shape) {
  WidestGap widest;
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  for (int f = 1; f <= faces.Extent(); ++f) {
    for (const FaceGap& gap : gapsOf(TopoDS::Face(faces(f)), widest.width))
      if (gap.width > widest.width) widest = {gap.width, gap.at};
  }
  return widest;
}

}  // namespace phront::cad
