#include "phront/cad/shape.h"

#include <BRepBndLib.hxx>
#include <Bnd_Box.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>

#include "phront/cad/shape_occt.h"

namespace phront::cad {

Shape makeShape(TopoDS_Shape shape) {
  if (shape.IsNull()) return Shape();
  return Shape(std::make_shared<const Shape::Impl>(Shape::Impl{std::move(shape)}));
}

const TopoDS_Shape& occtShape(const Shape& shape) {
  static const TopoDS_Shape kNull;
  return shape.empty() ? kNull : shape.impl().shape;
}

Box3 boundingBox(const Shape& shape) {
  Box3 box;
  if (shape.empty()) return box;
  Bnd_Box bnd;
  BRepBndLib::AddOptimal(occtShape(shape), bnd, Standard_False, Standard_False);
  if (bnd.IsVoid()) return box;
  const gp_Pnt lo = bnd.CornerMin();
  const gp_Pnt hi = bnd.CornerMax();
  box.extend(Vec3(lo.X(), lo.Y(), lo.Z()));
  box.extend(Vec3(hi.X(), hi.Y(), hi.Z()));
  return box;
}

Box3 boundingBox(const Model& model) {
  Box3 box;
  for (const Body& body : model.bodies) box.extend(boundingBox(body.shape));
  return box;
}

int faceCount(const Shape& shape) {
  TopTools_IndexedMapOfShape faces;
  if (!shape.empty()) TopExp::MapShapes(occtShape(shape), TopAbs_FACE, faces);
  return faces.Extent();
}

}  // namespace phront::cad
