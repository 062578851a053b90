// Closed faces are divided before they are offset, since General Fuse is not safe on seams; the
// user knows them whole. Faces that were two on the part stay two, so that each keeps its name and
// colour. ShapeUpgrade_UnifySameDomain hangs on some closed faces (OpenCASCADE 7.6): it runs in a
// child.
#include "rebuild/reunite.h"

#include <ShapeUpgrade_UnifySameDomain.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <string>
#include <vector>

#include "exchange/guard.h"
#include "exchange/shape_bytes.h"
#include "rebuild/origin.h"

namespace phront::cad {
namespace {

constexpr double kMemoryMiB = 2000;

int facesOf(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  return faces.Extent();
}

TopoDS_Shape reunited(const TopoDS_Shape& solids, const TrueDistance& phi) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(solids, TopAbs_FACE, faces);
  std::vector<Feature> origins;
  for (int f = 1; f <= faces.Extent(); ++f)
    origins.push_back(originOf(TopoDS::Face(faces(f)), phi));
  TopTools_IndexedDataMapOfShapeListOfShape facesOfEdge;
  TopExp::MapShapesAndAncestors(solids, TopAbs_EDGE, TopAbs_FACE, facesOfEdge);

  ShapeUpgrade_UnifySameDomain unify(solids, Standard_True, Standard_True, Standard_False);
  for (int e = 1; e <= facesOfEdge.Extent(); ++e) {
    const TopTools_ListOfShape& users = facesOfEdge(e);
    const Feature& one = origins[static_cast<std::size_t>(faces.FindIndex(users.First()) - 1)];
    const Feature& other = origins[static_cast<std::size_t>(faces.FindIndex(users.Last()) - 1)];
    if (one != other) unify.KeepShape(facesOfEdge.FindKey(e));
  }
  unify.Build();
  return unify.Shape();
}

}  // namespace

TopoDS_Shape reuniteFaces(const TopoDS_Shape& solids, const TrueDistance& phi, double seconds) {
  const Result<std::string> bytes =
      runInChild("reuniting faces", {seconds, kMemoryMiB}, [&]() -> Result<std::string> {
        const TopoDS_Shape whole = reunited(solids, phi);
        if (whole.IsNull() || facesOf(whole) >= facesOf(solids)) return std::string();
        return bytesOfShape(whole);
      });
  if (!bytes || bytes->empty()) return {};
  const Result<TopoDS_Shape> whole = shapeOfBytes(*bytes);
  return whole ? *whole : TopoDS_Shape();
}

}  // namespace phront::cad
