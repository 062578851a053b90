// The curve of the degenerated edge in (u,v) is right already: on the offset surface it is the
// curve that the pole opens into. It only takes an edge that is not degenerated, and two ends.
#include "patches/open_pole.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>

namespace phront::cad {
namespace {

TopoDS_Edge openedEdge(const TopoDS_Edge& degenerated, const TopoDS_Face& image,
                       const TopoDS_Vertex& one, const TopoDS_Vertex& other) {
  double first = 0;
  double last = 0;
  const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(degenerated, image, first, last);
  if (curve.IsNull()) return degenerated;
  const gp_Pnt2d uv = curve->Value(first);
  const gp_Pnt start = BRepAdaptor_Surface(image, Standard_False).Value(uv.X(), uv.Y());
  const bool inOrder = start.Distance(BRep_Tool::Pnt(one)) <= start.Distance(BRep_Tool::Pnt(other));
  const BRep_Builder builder;
  TopoDS_Edge edge;
  builder.MakeEdge(edge);
  builder.UpdateEdge(edge, curve, image, Precision::Confusion());
  builder.Add(edge, (inOrder ? one : other).Oriented(TopAbs_FORWARD));
  builder.Add(edge, (inOrder ? other : one).Oriented(TopAbs_REVERSED));
  builder.Range(edge, first, last);
  return edge;
}

TopoDS_Edge withEnd(const TopoDS_Edge& edge, const TopoDS_Vertex& old,
                    const TopoDS_Vertex& replacement) {
  const BRep_Builder builder;
  double first = 0;
  double last = 0;
  BRep_Tool::Range(edge, first, last);
  TopoDS_Edge copy = TopoDS::Edge(edge.EmptyCopied());
  for (TopoDS_Iterator it(edge); it.More(); it.Next()) {
    const TopoDS_Shape& vertex = it.Value();
    builder.Add(copy, vertex.IsSame(old) ? replacement.Oriented(vertex.Orientation()) : vertex);
  }
  builder.Range(copy, first, last);
  return copy;
}

}  // namespace

TopoDS_Face openPole(const EdgeTable& table, const OpenPole& pole, const VertexImages& vertices,
                     const TopoDS_Face& image) {
  const TopoDS_Vertex end1 = vertices.image(pole.vertex, pole.face, pole.side1);
  const TopoDS_Vertex end2 = vertices.image(pole.vertex, pole.face, pole.side2);
  if (end1.IsNull() || end2.IsNull()) return image;
  const TopoDS_Face& face = table.faces[static_cast<std::size_t>(pole.face)];
  const TopoDS_Shape original = face.Oriented(TopAbs_FORWARD);
  const TopoDS_Shape forward = image.Oriented(TopAbs_FORWARD);

  TopoDS_Vertex closed;  // the one vertex that the plain offset has there
  TopExp_Explorer from(original, TopAbs_EDGE);
  for (TopExp_Explorer to(forward, TopAbs_EDGE); to.More() && from.More(); to.Next(), from.Next())
    if (table.edgeIndex.FindIndex(from.Current()) - 1 == pole.edge)
      closed = TopExp::FirstVertex(TopoDS::Edge(to.Current()));
  if (closed.IsNull()) return image;

  const BRep_Builder builder;
  TopoDS_Shape result = forward.EmptyCopied();
  from.Init(original, TopAbs_EDGE);
  for (TopoDS_Iterator wire(forward); wire.More(); wire.Next()) {
    TopoDS_Shape kept = wire.Value().EmptyCopied();
    for (TopoDS_Iterator it(wire.Value()); it.More() && from.More(); it.Next(), from.Next()) {
      const TopoDS_Edge edge = TopoDS::Edge(it.Value().Oriented(TopAbs_FORWARD));
      const int e = table.edgeIndex.FindIndex(from.Current()) - 1;
      TopoDS_Shape mine = edge;
      if (e == pole.edge) mine = openedEdge(edge, image, end1, end2);
      if (e == pole.side1) mine = withEnd(edge, closed, end1);
      if (e == pole.side2) mine = withEnd(edge, closed, end2);
      builder.Add(kept, mine.Oriented(it.Value().Orientation()));
    }
    kept.Closed(wire.Value().Closed());
    builder.Add(result, kept);
  }
  return TopoDS::Face(result.Oriented(image.Orientation()));
}

}  // namespace phront::cad
