// OpenCASCADE's own hollow solid, for the table beside ours: what FreeCAD's thickness and
// CadQuery's shell call.
//   phront_thick_solid IN OUT.brep FACE T      FACE: number of the open face, from 1; T: mm,
//   inwards
// Exit 0 a shape was written; 1 none came; 2 usage; 3 unreadable.
#include <fmt/format.h>

#include <BRepOffsetAPI_MakeThickSolid.hxx>
#include <BRepTools.hxx>
#include <OSD.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <cstdlib>

#include "phront/cad/exchange.h"
#include "phront/cad/shape_occt.h"

int main(int argc, char** argv) {
  if (argc != 5) {
    fmt::print(stderr, "usage: phront_thick_solid IN OUT.brep FACE T\n");
    return 2;
  }
  const auto model = phront::cad::readModel(argv[1]);
  if (!model || model->bodies.size() != 1) return 3;
  const TopoDS_Shape& solid = phront::cad::occtShape(model->bodies.front().shape);
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(solid, TopAbs_FACE, faces);
  const int face = std::atoi(argv[3]);
  if (face < 1 || face > faces.Extent()) return 2;
  OSD::SetSignal(Standard_False);
  try {
    TopTools_ListOfShape open;
    open.Append(faces(face));
    BRepOffsetAPI_MakeThickSolid thick;
    thick.MakeThickSolidByJoin(solid, open, -std::atof(argv[4]), 1e-4, BRepOffset_Skin,
                               Standard_False, Standard_False, GeomAbs_Arc);
    if (!thick.IsDone() || thick.Shape().IsNull()) return 1;
    return BRepTools::Write(thick.Shape(), argv[2]) ? 0 : 1;
  } catch (const Standard_Failure&) {
    return 1;
  }
}
