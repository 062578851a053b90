// General Fuse leaves a line that ends inside a piece as an internal edge, or, where it leads from
// an outline to a hole, as an edge that the face passes in both directions. With such an edge in
// two pieces no cell closes.
#include "rebuild/inner_edges.h"

#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfOrientedShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

namespace phront::cad {
namespace {

/// Do the edges, as they are directed, make closed loops? Then these, as wires.
std::optional<std::vector<TopoDS_Wire>> loopsOf(std::vector<TopoDS_Edge> edges) {
  const BRep_Builder builder;
  std::vector<TopoDS_Wire> loops;
  while (!edges.empty()) {
    TopoDS_Wire loop;
    builder.MakeWire(loop);
    const TopoDS_Vertex start = TopExp::FirstVertex(edges.front(), Standard_True);
    for (TopoDS_Vertex at = start; loop.Closed() == Standard_False;) {
      const auto next = std::find_if(edges.begin(), edges.end(), [&](const TopoDS_Edge& edge) {
        return TopExp::FirstVertex(edge, Standard_True).IsSame(at);
      });
      if (next == edges.end()) return std::nullopt;
      builder.Add(loop, *next);
      at = TopExp::LastVertex(*next, Standard_True);
      edges.erase(next);
      loop.Closed(at.IsSame(start));
    }
    loops.push_back(loop);
  }
  return loops;
}

}  // namespace

TopoDS_Face withoutInnerEdges(const TopoDS_Face& face) {
  const TopoDS_Face forward = TopoDS::Face(face.Oriented(TopAbs_FORWARD));
  TopTools_IndexedMapOfOrientedShape uses;
  for (TopExp_Explorer edge(forward, TopAbs_EDGE); edge.More(); edge.Next())
    uses.Add(edge.Current());
  const auto isInner = [&](const TopoDS_Edge& edge) {
    if (edge.Orientation() == TopAbs_INTERNAL) return true;
    return uses.Contains(edge.Reversed()) && !BRep_Tool::IsClosed(edge, forward);
  };
  const BRep_Builder builder;
  TopoDS_Shape bare = forward.EmptyCopied();
  std::vector<TopoDS_Edge> loose;  // of the wires that had such edges
  bool changed = false;
  for (TopoDS_Iterator wire(forward); wire.More(); wire.Next()) {
    std::vector<TopoDS_Edge> kept;
    int count = 0;
    for (TopoDS_Iterator edge(wire.Value()); edge.More(); edge.Next(), ++count)
      if (!isInner(TopoDS::Edge(edge.Value()))) kept.push_back(TopoDS::Edge(edge.Value()));
    if (static_cast<int>(kept.size()) == count) {
      builder.Add(bare, wire.Value());
      continue;
    }
    changed = true;
    loose.insert(loose.end(), kept.begin(), kept.end());
  }
  if (!changed) return face;
  const std::optional<std::vector<TopoDS_Wire>> loops = loopsOf(std::move(loose));
  if (!loops) return face;
  for (const TopoDS_Wire& loop : *loops) builder.Add(bare, loop);
  return TopoDS::Face(bare.Oriented(face.Orientation()));
}

}  // namespace phront::cad
