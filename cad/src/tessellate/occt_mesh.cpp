// Runs BRepMesh and reads what it left on the shape.
//
// BRepMesh discretises every edge once, then fills each face in its (u,v) with a Delaunay
// triangulation constrained by the edges' points; the polygons on the triangulation say which nodes
// of the face are which points of an edge. That makes neighbours conform without comparing
// coordinates. Weak spot: faces whose wires cross themselves in (u,v) at the given deflection get
// no triangles; they are tried again with the other Delaunay code, then all faces with a finer
// deflection, so that neighbours still conform. Some plain faces fail, too, by an accident of
// numbers (seen: a full cone at 45 degrees) that does not happen to a shape a little larger.
#include "tessellate/occt_mesh.h"

#include <BRepBuilderAPI_Transform.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <IMeshTools_Parameters.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TColStd_HArray1OfReal.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <array>
#include <gp_Trsf.hxx>

#include "tessellate/face_surface.h"

namespace phront::cad {
namespace {

Index indexIn(const TopTools_IndexedMapOfShape& map, const TopoDS_Shape& shape) {
  return shape.IsNull() ? kNone : map.FindIndex(shape) - 1;
}

bool hasTriangles(const TopoDS_Face& face) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) t = BRep_Tool::Triangulation(face, location);
  return !t.IsNull() && t->NbTriangles() > 0;
}

void mesh(const TopoDS_Shape& shape, double deflection, double angle,
          IMeshTools_MeshAlgoType algorithm) {
  IMeshTools_Parameters parameters;
  parameters.Deflection = deflection;
  parameters.Angle = angle;
  parameters.AngleInterior = angle;
  parameters.MeshAlgo = algorithm;
  parameters.InParallel = Standard_False;
  parameters.AllowQualityDecrease = Standard_True;
  BRepMesh_IncrementalMesh(shape, parameters);
}

EdgePolygon polygonOf(const TopoDS_Edge& edge, const Handle(Poly_Triangulation) & triangulation,
                      const TopLoc_Location& location, const ShapeMaps& maps) {
  EdgePolygon result;
  const Handle(Poly_PolygonOnTriangulation) polygon =
      BRep_Tool::PolygonOnTriangulation(edge, triangulation, location);
  if (polygon.IsNull()) return result;
  result.edge = indexIn(maps.edges, edge);
  result.degenerated = BRep_Tool::Degenerated(edge);
  const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
  result.firstVertex = indexIn(maps.vertices, TopExp::FirstVertex(forward));
  result.lastVertex = indexIn(maps.vertices, TopExp::LastVertex(forward));
  const Handle(TColStd_HArray1OfReal) parameters = polygon->Parameters();
  for (int k = 1; k <= polygon->NbNodes(); ++k) {
    result.nodes.push_back(polygon->Node(k) - 1);
    result.parameters.push_back(parameters.IsNull() ? 0 : parameters->Value(k));
  }
  return result;
}

FaceMesh readFace(const TopoDS_Face& face, const ShapeMaps& maps) {
  FaceMesh result;
  result.face = indexIn(maps.faces, face);
  TopLoc_Location location;
  const Handle(Poly_Triangulation) t = BRep_Tool::Triangulation(face, location);
  if (t.IsNull()) return result;
  const gp_Trsf place = location.Transformation();
  for (int k = 1; k <= t->NbNodes(); ++k) {
    result.nodes.push_back(toVec3(t->Node(k).Transformed(place).XYZ()));
    const gp_Pnt2d uv = t->HasUVNodes() ? t->UVNode(k) : gp_Pnt2d();
    result.uv.emplace_back(uv.X(), uv.Y());
  }
  const bool flip = (face.Orientation() == TopAbs_REVERSED) != place.IsNegative();
  for (int k = 1; k <= t->NbTriangles(); ++k) {
    int a = 0;
    int b = 0;
    int c = 0;
    t->Triangle(k).Get(a, b, c);
    if (flip) std::swap(b, c);
    result.triangles.push_back({a - 1, b - 1, c - 1});
  }
  const TopoDS_Shape forward = face.Oriented(TopAbs_FORWARD);
  for (TopExp_Explorer e(forward, TopAbs_EDGE); e.More(); e.Next()) {
    EdgePolygon polygon = polygonOf(TopoDS::Edge(e.Current()), t, location, maps);
    if (polygon.edge != kNone) result.polygons.push_back(std::move(polygon));
  }
  return result;
}

int countFailed(const ShapeMaps& maps) {
  int count = 0;
  for (int k = 1; k <= maps.faces.Extent(); ++k)
    if (!hasTriangles(TopoDS::Face(maps.faces(k)))) ++count;
  return count;
}

/// Another way to mesh all: a shape a little larger, or shorter sides.
struct Change {
  double scale = 1;
  double fineness = 1;
};

constexpr double kFiner = 4;
/// Scales that leave parameters what they are for all that they are used for.
constexpr std::array kChanges{Change{1 + 1e-7, 1}, Change{1 - 1e-7, 1}, Change{1 + 1e-6, 1},
                              Change{1, kFiner}};

TopoDS_Shape scaled(const TopoDS_Shape& shape, double scale) {
  gp_Trsf transformation;
  transformation.SetScaleFactor(scale);
  return BRepBuilderAPI_Transform(shape, transformation, Standard_True).Shape();
}

/// Would a face without triangles get some?
bool helps(const Change& change, const ShapeMaps& maps, double deflection, double angle) {
  for (int k = 1; k <= maps.faces.Extent(); ++k) {
    if (hasTriangles(TopoDS::Face(maps.faces(k)))) continue;
    const TopoDS_Face copy = TopoDS::Face(scaled(maps.faces(k), change.scale));
    mesh(copy, deflection / change.fineness, angle, IMeshTools_MeshAlgoType_Watson);
    if (hasTriangles(copy)) return true;
  }
  return false;
}

/// Faces without triangles alone, with the points that their edges have by now.
void tryAgain(const ShapeMaps& maps, double deflection, double angle) {
  for (int k = 1; k <= maps.faces.Extent(); ++k) {
    if (hasTriangles(TopoDS::Face(maps.faces(k)))) continue;
    mesh(maps.faces(k), deflection, angle, IMeshTools_MeshAlgoType_Delabella);
  }
}

ShapeMesh readMesh(const TopoDS_Shape& shape, const ShapeMaps& maps) {
  ShapeMesh result;
  for (TopExp_Explorer e(shape, TopAbs_FACE); e.More(); e.Next()) {
    const TopoDS_Face face = TopoDS::Face(e.Current());
    if (face.Orientation() != TopAbs_FORWARD && face.Orientation() != TopAbs_REVERSED) continue;
    result.faces.push_back(readFace(face, maps));
    if (result.faces.back().triangles.empty()) result.failed.push_back(result.faces.back().face);
  }
  return result;
}

}  // namespace

ShapeMaps::ShapeMaps(const TopoDS_Shape& shape) {
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  TopExp::MapShapes(shape, TopAbs_EDGE, edges);
  TopExp::MapShapes(shape, TopAbs_VERTEX, vertices);
}

ShapeMesh meshShape(const TopoDS_Shape& shape, const ShapeMaps& maps, double deflection,
                    double angle) {
  BRepTools::Clean(shape);
  mesh(shape, deflection, angle, IMeshTools_MeshAlgoType_Watson);
  tryAgain(maps, deflection, angle);
  const int failed = countFailed(maps);
  if (failed == 0) return readMesh(shape, maps);
  for (const Change& change : kChanges) {
    if (!helps(change, maps, deflection, angle)) continue;
    const TopoDS_Shape copy = scaled(shape, change.scale);
    const ShapeMaps copyMaps(copy);
    mesh(copy, deflection / change.fineness, angle, IMeshTools_MeshAlgoType_Watson);
    tryAgain(copyMaps, deflection / change.fineness, angle);
    if (countFailed(copyMaps) >= failed) continue;
    ShapeMesh result = readMesh(copy, copyMaps);
    for (FaceMesh& face : result.faces)
      for (Vec3& node : face.nodes) node /= change.scale;
    return result;
  }
  for (const double coarser : {1.0 / kFiner, kFiner}) tryAgain(maps, coarser * deflection, angle);
  return readMesh(shape, maps);
}

void meshOutlines(const TopoDS_Shape& shape, double deflection, double angle) {
  IMeshTools_Parameters parameters;
  parameters.Deflection = deflection;
  parameters.Angle = angle;
  parameters.InParallel = Standard_False;
  parameters.InternalVerticesMode = Standard_False;
  parameters.ControlSurfaceDeflection = Standard_False;
  BRepMesh_IncrementalMesh(shape, parameters);
}

}  // namespace phront::cad
