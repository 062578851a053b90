// BOPAlgo_MakerVolume makes every closed cell of a set of faces that share edges, with cavities and
// orientation.
#include "rebuild/cells.h"

#include <BOPAlgo_MakerVolume.hxx>
#include <BRep_Tool.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>

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

}  // namespace phront::cad
