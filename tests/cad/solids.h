// Solids with known shape for the tests of cad.
#pragma once

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <gp_Pnt.hxx>
#include <gp_Trsf.hxx>

#include "phront/cad/shape.h"
#include "phront/cad/shape_occt.h"

namespace phront::cad::test {

inline Body solidBody(const TopoDS_Shape& shape) {
  Body body;
  body.shape = makeShape(shape);
  body.kind = BodyKind::Solid;
  return body;
}

inline TopoDS_Shape box(double x, double y, double z) {
  return BRepPrimAPI_MakeBox(x, y, z).Solid();
}
inline TopoDS_Shape cylinder(double radius, double height) {
  return BRepPrimAPI_MakeCylinder(radius, height).Solid();
}
inline TopoDS_Shape sphere(double radius) { return BRepPrimAPI_MakeSphere(radius).Solid(); }
/// Apex at the top.
inline TopoDS_Shape cone(double radius, double height) {
  return BRepPrimAPI_MakeCone(radius, 0, height).Solid();
}
inline TopoDS_Shape torus(double major, double minor) {
  return BRepPrimAPI_MakeTorus(major, minor).Solid();
}

/// 2 x 2 x 1 block without its quarter x > 1, y > 1.
inline TopoDS_Shape lShape() {
  const TopoDS_Shape tool = BRepPrimAPI_MakeBox(gp_Pnt(1, 1, -1), gp_Pnt(3, 3, 3)).Solid();
  const TopoDS_Shape cut = BRepAlgoAPI_Cut(box(2, 2, 1), tool).Shape();
  return TopExp_Explorer(cut, TopAbs_SOLID).Current();
}

/// Box with all twelve edges rounded.
inline TopoDS_Shape filletedBox(double side, double radius) {
  const TopoDS_Shape block = box(side, side, side);
  BRepFilletAPI_MakeFillet fillet(block);
  for (TopExp_Explorer e(block, TopAbs_EDGE); e.More(); e.Next()) {
    fillet.Add(radius, TopoDS::Edge(e.Current()));
  }
  return TopExp_Explorer(fillet.Shape(), TopAbs_SOLID).Current();
}

/// Smooth B-spline loft through three squares of sides 4, 2, 4 at z = 0, 3, 6.
inline TopoDS_Shape loft() {
  BRepOffsetAPI_ThruSections sections(Standard_True, Standard_False);
  for (const auto& [half, z] : {std::pair(2.0, 0.0), std::pair(1.0, 3.0), std::pair(2.0, 6.0)}) {
    BRepBuilderAPI_MakePolygon square(gp_Pnt(-half, -half, z), gp_Pnt(half, -half, z),
                                      gp_Pnt(half, half, z), gp_Pnt(-half, half, z), Standard_True);
    sections.AddWire(square.Wire());
  }
  sections.Build();
  return TopExp_Explorer(sections.Shape(), TopAbs_SOLID).Current();
}

inline TopoDS_Shape transformed(const TopoDS_Shape& shape, const gp_Trsf& trsf) {
  return BRepBuilderAPI_Transform(shape, trsf, Standard_True).Shape();
}

}  // namespace phront::cad::test
