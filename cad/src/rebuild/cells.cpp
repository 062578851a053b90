// BOPAlgo_MakerVolume makes every closed cell of a set of faces that share edges, with cavities and
// orientation.
#include "rebuild/cells.h"

#include <BOPAlgo_MakerVolume.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>

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

}  // namespace phront::cad
