// Where intersection curves end short of one another, vertices get tolerances that swallow whole
// edges and the slivers between them. In memory that is valid; a file does not carry tolerances,
// and what reads it finds holes outside of their faces.
#include "rebuild/tiny_edges.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepTools_ReShape.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <TopExp.hxx>
#include <TopTools_DataMapOfShapeShape.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "patches/patch_tools.h"
#include "rebuild/cells.h"

namespace phront::cad {
namespace {

constexpr int kSamples = 16;  // on an edge

bool liesWithin(const TopoDS_Edge& edge, const TopoDS_Vertex& vertex) {
  const BRepAdaptor_Curve curve(edge);
  const gp_Pnt centre = BRep_Tool::Pnt(vertex);
  const double reach = BRep_Tool::Tolerance(vertex);
  for (int i = 0; i <= kSamples; ++i) {
    const double t =
        std::lerp(curve.FirstParameter(), curve.LastParameter(), static_cast<double>(i) / kSamples);
    if (curve.Value(t).Distance(centre) > reach) return false;
  }
  return true;
}

class Collapse {
 public:
  explicit Collapse(const TopoDS_Shape& shape) : shape_(shape) {
    const std::vector<TopoDS_Shape> edges = partsOf(shape, TopAbs_EDGE);
    // Vertices that become one may swallow further edges between them.
    for (bool found = true; found;) {
      found = false;
      for (const TopoDS_Shape& edge : edges)
        if (!tiny_.Contains(edge) && take(TopoDS::Edge(edge))) found = true;
    }
  }

  [[nodiscard]] bool isNeeded() const { return !tiny_.IsEmpty(); }

  [[nodiscard]] TopoDS_Shape perform() const {
    BRepTools_ReShape change;
    for (const TopoDS_Shape& edge : partsOf(shape_, TopAbs_EDGE))
      if (tiny_.Contains(edge)) change.Remove(edge);
    TopTools_DataMapOfShapeShape merged;  // by root; the shape's own vertices stay as they are
    for (const TopoDS_Shape& vertex : partsOf(shape_, TopAbs_VERTEX)) {
      const TopoDS_Vertex forward = TopoDS::Vertex(vertex.Oriented(TopAbs_FORWARD));
      const TopoDS_Vertex root = rootOf(forward);
      if (root.IsSame(forward)) continue;
      const gp_Pnt place = BRep_Tool::Pnt(root);
      if (!merged.IsBound(root)) {
        merged.Bind(root, makeVertex(place, BRep_Tool::Tolerance(root)));
        change.Replace(root, merged.Find(root));
      }
      const double reach = place.Distance(BRep_Tool::Pnt(forward)) + BRep_Tool::Tolerance(forward);
      BRep_Builder().UpdateVertex(TopoDS::Vertex(merged.Find(root)), reach);
      change.Replace(forward, merged.Find(root));
    }
    for (const TopoDS_Shape& wire : partsOf(shape_, TopAbs_WIRE))
      if (isTiny(wire)) change.Remove(wire);
    for (const TopoDS_Shape& face : partsOf(shape_, TopAbs_FACE))
      if (isTiny(face)) change.Remove(face);
    return change.Apply(shape_);
  }

 private:
  /// Collapses the edge, if it is tiny.
  bool take(const TopoDS_Edge& edge) {
    TopoDS_Vertex first;
    TopoDS_Vertex last;
    TopExp::Vertices(edge, first, last);
    if (BRep_Tool::Degenerated(edge) || first.IsNull() || last.IsNull()) return false;
    first = rootOf(first);
    last = rootOf(last);
    if (!liesWithin(edge, first) && !liesWithin(edge, last)) return false;
    tiny_.Add(edge);
    unite(first, last);
    return true;
  }

  /// All its edges are.
  [[nodiscard]] bool isTiny(const TopoDS_Shape& shape) const {
    const std::vector<TopoDS_Shape> edges = partsOf(shape, TopAbs_EDGE);
    return !edges.empty() && std::all_of(edges.begin(), edges.end(),
                                         [&](const TopoDS_Shape& e) { return tiny_.Contains(e); });
  }

  [[nodiscard]] TopoDS_Vertex rootOf(TopoDS_Vertex vertex) const {
    while (const TopoDS_Shape* next = parent_.Seek(vertex)) vertex = TopoDS::Vertex(*next);
    return vertex;
  }

  /// Of two roots the one with the larger tolerance stands for both.
  void unite(const TopoDS_Vertex& a, const TopoDS_Vertex& b) {
    TopoDS_Vertex kept = TopoDS::Vertex(a.Oriented(TopAbs_FORWARD));
    TopoDS_Vertex gone = TopoDS::Vertex(b.Oriented(TopAbs_FORWARD));
    if (kept.IsSame(gone)) return;
    if (BRep_Tool::Tolerance(kept) < BRep_Tool::Tolerance(gone)) std::swap(kept, gone);
    parent_.Bind(gone, kept);
  }

  const TopoDS_Shape& shape_;
  TopTools_MapOfShape tiny_;
  TopTools_DataMapOfShapeShape parent_;
};

}  // namespace

TopoDS_Shape withoutTinyEdges(const TopoDS_Shape& shape) {
  const Collapse collapse(shape);
  if (!collapse.isNeeded()) return shape;
  const TopoDS_Shape rest = collapse.perform();
  if (rest.IsNull() || partsOf(rest, TopAbs_SOLID).empty()) return shape;
  const bool sound =
      BRepCheck_Analyzer(rest).IsValid() && countOpenEdges(rest) <= countOpenEdges(shape);
  return sound ? rest : shape;
}

}  // namespace phront::cad
