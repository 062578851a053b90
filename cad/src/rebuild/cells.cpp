// BOPAlgo_MakerVolume makes every closed cell of a set of faces that share edges, with cavities and
// orientation.
#include "rebuild/cells.h"

#include <BOPAlgo_MakerVolume.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <algorithm>
#include <functional>
#include <numeric>

#include "exchange/measures.h"
#include "rebuild/edge_uses.h"

namespace phront::cad {

std::vector<TopoDS_Shape> partsOf(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
  std::vector<TopoDS_Shape> parts;
  if (shape.IsNull()) return parts;
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(shape, kind, map);
  for (int i = 1; i <= map.Extent(); ++i) parts.push_back(map(i));
  return parts;
}

std::vector<TopoDS_Shape> cellsOf(const std::vector<TopoDS_Shape>& faces) {
  if (faces.empty()) return {};
  BOPAlgo_MakerVolume maker;
  TopTools_ListOfShape arguments;
  for (const TopoDS_Shape& face : faces) arguments.Append(face);
  maker.SetArguments(arguments);
  maker.SetIntersect(Standard_False);
  maker.SetAvoidInternalShapes(Standard_True);
  maker.SetRunParallel(Standard_False);
  maker.Perform();
  if (maker.HasErrors()) return {};
  return partsOf(maker.Shape(), TopAbs_SOLID);
}

std::vector<TopoDS_Face> wallsOf(const TopoDS_Shape& cell) {
  std::vector<TopoDS_Face> walls;
  for (TopExp_Explorer it(cell, TopAbs_FACE); it.More(); it.Next()) {
    const TopAbs_Orientation side = it.Current().Orientation();
    if (side == TopAbs_FORWARD || side == TopAbs_REVERSED)
      walls.push_back(TopoDS::Face(it.Current()));
  }
  return walls;
}

std::vector<TopoDS_Face> skinOf(const std::vector<TopoDS_Shape>& cells) {
  TopTools_IndexedMapOfShape faces;
  std::vector<TopoDS_Face> asUsed;
  std::vector<int> uses;
  for (const TopoDS_Shape& cell : cells) {
    for (const TopoDS_Face& wall : wallsOf(cell)) {
      const auto f = static_cast<std::size_t>(faces.Add(wall));
      if (uses.size() < f) {
        uses.push_back(0);
        asUsed.push_back(wall);
      }
      ++uses[f - 1];
    }
  }
  std::vector<TopoDS_Face> skin;
  for (std::size_t f = 0; f < uses.size(); ++f)
    if (uses[f] == 1) skin.push_back(asUsed[f]);
  return skin;
}

int countOpenEdges(const TopoDS_Shape& shape) {
  int open = 0;
  for (const TopoDS_Shape& shell : partsOf(shape, TopAbs_SHELL)) {
    TopTools_DataMapOfShapeInteger uses;
    TopTools_IndexedMapOfShape edges;
    for (TopExp_Explorer it(shell, TopAbs_EDGE); it.More(); it.Next()) {
      if (BRep_Tool::Degenerated(TopoDS::Edge(it.Current()))) continue;
      edges.Add(it.Current());
      if (uses.IsBound(it.Current()))
        ++uses.ChangeFind(it.Current());
      else
        uses.Bind(it.Current(), 1);
    }
    for (int i = 1; i <= edges.Extent(); ++i) open += uses.Find(edges(i)) == 2 ? 0 : 1;
  }
  return open;
}

std::vector<TopoDS_Face> inReadingOrder(const std::vector<TopoDS_Face>& faces) {
  const EdgeUses uses(faces);
  std::vector<std::vector<std::size_t>> beside(faces.size());
  for (const std::vector<std::size_t>& users : uses.faces) {
    for (const std::size_t f : users)
      for (const std::size_t g : users)
        if (f != g) beside[f].push_back(g);
  }
  std::vector<double> areas;
  for (const TopoDS_Face& face : faces) areas.push_back(areaOf(face));
  std::vector<std::size_t> bySize(faces.size());
  std::iota(bySize.begin(), bySize.end(), std::size_t{0});
  std::ranges::stable_sort(bySize, std::ranges::greater{}, [&](std::size_t f) { return areas[f]; });
  std::vector<TopoDS_Face> ordered;
  std::vector<char> taken(faces.size(), 0);
  for (const std::size_t first : bySize) {
    if (taken[first]) continue;
    taken[first] = 1;
    std::vector<std::size_t> connected{first};
    for (std::size_t at = 0; at < connected.size(); ++at) {
      ordered.push_back(faces[connected[at]]);
      for (const std::size_t next : beside[connected[at]]) {
        if (taken[next]) continue;
        taken[next] = 1;
        connected.push_back(next);
      }
    }
  }
  return ordered;
}

TopoDS_Shape solidInReadingOrder(const TopoDS_Shape& solid) {
  const BRep_Builder builder;
  TopoDS_Solid ordered;
  builder.MakeSolid(ordered);
  const TopoDS_Shape forward = solid.Oriented(TopAbs_FORWARD);
  for (TopExp_Explorer shell(forward, TopAbs_SHELL); shell.More(); shell.Next()) {
    std::vector<TopoDS_Face> faces;
    for (TopExp_Explorer f(shell.Current(), TopAbs_FACE); f.More(); f.Next())
      faces.push_back(TopoDS::Face(f.Current()));
    TopoDS_Shell made;
    builder.MakeShell(made);
    for (const TopoDS_Face& face : inReadingOrder(faces)) builder.Add(made, face);
    made.Closed(shell.Current().Closed());
    builder.Add(ordered, made);
  }
  return ordered.Oriented(solid.Orientation());
}

}  // namespace phront::cad
