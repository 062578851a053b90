// OpenCASCADE's own hollow solid, for the table beside ours: what FreeCAD's thickness and
// CadQuery's shell call.
//   phront_thick_solid IN OUT.brep FACE T      FACE: number of the open face, from 1; T: mm,
//   inwards
// Exit 0 a shape was written; 1 none came; 2 usage; 3 unreadable.
#include <fmt/format.h>

#include <BRepCheck_Analyzer.hxx>
#include <BRepOffsetAPI_MakeThickSolid.hxx>
#include <BRepTools.hxx>
#include <OSD.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS_Shape.hxx>
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
  TopTools_ListOfShape open;
  open.Append(faces(face));
  TopoDS_Shape best;
  // FreeCAD's default, then CadQuery's; the first that is valid, else the first at all.
  for (const bool intersection : {false, true}) {
    try {
      BRepOffsetAPI_MakeThickSolid thick;
      thick.MakeThickSolidByJoin(solid, open, -std::atof(argv[4]), 1e-4, BRepOffset_Skin,
                                 intersection, Standard_False, GeomAbs_Arc);
      if (!thick.IsDone() || thick.Shape().IsNull()) continue;
      const bool valid = BRepCheck_Analyzer(thick.Shape()).IsValid();
      if (best.IsNull() || valid) best = thick.Shape();
      if (valid) break;
    } catch (const Standard_Failure&) {
      continue;
    }
  }
  return !best.IsNull() && BRepTools::Write(best, argv[2]) ? 0 : 1;
}
