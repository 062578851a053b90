// Makes the sample part: an angle bracket with a rounded bend, round corners, a gusset and four
// holes. Usage: make_bracket OUT.step
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRep_Tool.hxx>
#include <GC_MakeArcOfCircle.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <cmath>
#include <cstdio>
#include <gp_Ax2.hxx>

#include "phront/cad/exchange.h"
#include "phront/cad/shape_occt.h"

namespace {

// All in mm. The bend runs along y; the base lies in z = 0, the wall in x = 0.
constexpr double kLength = 80;  // of the base, x
constexpr double kWidth = 60;   // y
constexpr double kHeight = 60;  // of the wall, z
constexpr double kThickness = 8;
constexpr double kInnerBend = 4;      // radius, concave
constexpr double kOuterBend = 9;      // radius, convex
constexpr double kCornerRadius = 12;  // of the plates' free corners
constexpr double kGussetLeg = 32;     // from the inner faces
constexpr double kGussetThickness = 7;
constexpr double kHoleRadius = 4;

gp_Pnt at(double x, double z) { return {x, 0, z}; }

/// Arc that rounds the corner with the given centre, from `from` to `to`.
TopoDS_Edge arc(const gp_Pnt& from, const gp_Pnt& centre, const gp_Pnt& corner, const gp_Pnt& to) {
  const gp_Vec towardsCorner(centre, corner);
  const gp_Pnt middle = centre.Translated(towardsCorner.Normalized() * centre.Distance(from));
  return BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(from, middle, to).Value());
}

/// The angle: its profile in the plane y = 0, drawn out to the width.
TopoDS_Shape makeAngle() {
  const double t = kThickness;
  const double in = t + kInnerBend;
  const double out = kOuterBend;
  const auto line = [](const gp_Pnt& a, const gp_Pnt& b) -> TopoDS_Edge {
    return BRepBuilderAPI_MakeEdge(a, b);
  };
  BRepBuilderAPI_MakeWire profile;
  profile.Add(line(at(out, 0), at(kLength, 0)));
  profile.Add(line(at(kLength, 0), at(kLength, t)));
  profile.Add(line(at(kLength, t), at(in, t)));
  profile.Add(arc(at(in, t), at(in, in), at(t, t), at(t, in)));
  profile.Add(line(at(t, in), at(t, kHeight)));
  profile.Add(line(at(t, kHeight), at(0, kHeight)));
  profile.Add(line(at(0, kHeight), at(0, out)));
  profile.Add(arc(at(0, out), at(out, out), at(0, 0), at(out, 0)));
  const TopoDS_Face face = BRepBuilderAPI_MakeFace(profile.Wire());
  return BRepPrimAPI_MakePrism(face, gp_Vec(0, kWidth, 0)).Shape();
}

/// Rounds the four free corners of the plates: the edges of plate thickness at their far ends.
TopoDS_Shape roundCorners(const TopoDS_Shape& angle) {
  BRepFilletAPI_MakeFillet fillet(angle);
  TopTools_IndexedMapOfShape edges;
  TopExp::MapShapes(angle, TopAbs_EDGE, edges);
  for (int i = 1; i <= edges.Extent(); ++i) {
    const TopoDS_Edge& edge = TopoDS::Edge(edges(i));
    const gp_Pnt a = BRep_Tool::Pnt(TopExp::FirstVertex(edge));
    const gp_Pnt b = BRep_Tool::Pnt(TopExp::LastVertex(edge));
    const bool acrossPlate = std::abs(a.Distance(b) - kThickness) < 1e-9;
    if (acrossPlate && std::abs(a.Y() - b.Y()) < 1e-9) fillet.Add(kCornerRadius, edge);
  }
  return fillet.Shape();
}

/// Triangular rib in the middle of the bend; its hidden corner lies inside the angle.
TopoDS_Shape makeGusset() {
  const double hidden = kThickness / 2;
  const double reach = kThickness + kGussetLeg + (kThickness - hidden);
  BRepBuilderAPI_MakePolygon triangle(at(hidden, hidden), at(reach, hidden), at(hidden, reach),
                                      true);
  const TopoDS_Face face = BRepBuilderAPI_MakeFace(triangle.Wire());
  gp_Trsf toMiddle;
  toMiddle.SetTranslation(gp_Vec(0, (kWidth - kGussetThickness) / 2, 0));
  return BRepPrimAPI_MakePrism(face.Moved(toMiddle), gp_Vec(0, kGussetThickness, 0)).Shape();
}

TopoDS_Shape drill(const TopoDS_Shape& part, const gp_Pnt& from, const gp_Dir& direction) {
  const TopoDS_Shape bit =
      BRepPrimAPI_MakeCylinder(gp_Ax2(from, direction), kHoleRadius, 2 * kThickness).Shape();
  return BRepAlgoAPI_Cut(part, bit).Shape();
}

TopoDS_Shape makeBracket() {
  BRepAlgoAPI_Fuse fuse(roundCorners(makeAngle()), makeGusset());
  fuse.SimplifyResult();
  TopoDS_Shape part = fuse.Shape();
  for (const double y : {0.25 * kWidth, 0.75 * kWidth}) {
    part = drill(part, gp_Pnt(0.75 * kLength, y, -kThickness / 2), gp::DZ());
    part = drill(part, gp_Pnt(-kThickness / 2, y, 0.7 * kHeight), gp::DX());
  }
  const TopExp_Explorer solid(part, TopAbs_SOLID);
  return solid.More() ? solid.Current() : TopoDS_Shape();
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_bracket OUT.step\n");
    return 2;
  }
  const TopoDS_Shape bracket = makeBracket();
  if (bracket.IsNull() || !BRepCheck_Analyzer(bracket).IsValid()) {
    std::fprintf(stderr, "the bracket could not be made\n");
    return 1;
  }
  phront::cad::Body body;
  body.shape = phront::cad::makeShape(bracket);
  body.name = "bracket";
  phront::cad::Model model;
  model.bodies.push_back(body);
  const auto written = phront::cad::writeModel(model, argv[1]);
  if (!written) {
    std::fprintf(stderr, "%s\n", written.error().message.c_str());
    return 1;
  }
  std::printf("%s: %d faces\n", argv[1], phront::cad::faceCount(body.shape));
  return 0;
} catch (const Standard_Failure& e) {
  std::fprintf(stderr, "the bracket could not be made: %s\n", e.GetMessageString());
  return 1;
}
