// Convexity is sampled: the angle between the two outward normals, signed by the edge's direction
// in the first face, (n1 x n2).t > 0 for a convex edge. An edge may change from convex to concave;
// it gets a pipe when it is convex anywhere. Where the normals are opposite to each other the faces
// themselves tell, a little beside the edge, as for a wall that tapers to nothing.
#include "patches/edge_table.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRep_Tool.hxx>
#include <GCPnts_AbscissaPoint.hxx>
#include <Geom2d_Curve.hxx>
#include <Precision.hxx>
#include <ShapeAnalysis_Surface.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>

#include "patches/patch_tools.h"

namespace phront::cad {
namespace {

constexpr int kEdgeSamples = 9;
constexpr double kKnife = 1e-6;   // rad, from half a turn: the sign of the angle is round-off
constexpr double kTilt = 1e-9;    // rad
constexpr double kBeside = 0.02;  // of the edge's length

/// The edge as the face uses it, with its orientation there; null when it is not the face's.
TopoDS_Edge useInFace(const TopoDS_Edge& edge, const TopoDS_Face& face) {
  for (const TopoDS_Edge& candidate : edgesOf(face)) {
    if (candidate.IsSame(edge)) return candidate;
  }
  return {};
}

std::optional<gp_Vec> normalAlong(const TopoDS_Edge& use, const TopoDS_Face& face, double share) {
  double first = 0;
  double last = 0;
  const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(use, face, first, last);
  if (curve.IsNull()) return std::nullopt;
  return outwardNormal(face, curve->Value(first + share * (last - first)));
}

/// Where the faces of a knife's edge go the same way from it, is the material between them?
/// `step` leads from a point of the edge along both, `n1` is the first one's outward normal.
bool isBetween(const gp_Pnt& point, const gp_Vec& step, const gp_Vec& n1, const TopoDS_Face& face1,
               const TopoDS_Face& face2) {
  const gp_Pnt beside = point.Translated(step);
  const auto onFace = [&](const TopoDS_Face& face) {
    ShapeAnalysis_Surface surface(BRep_Tool::Surface(face));
    const gp_Pnt2d uv = surface.ValueOfUV(beside, Precision::Confusion());
    return surface.Value(uv);
  };
  return gp_Vec(onFace(face1), onFace(face2)).Dot(n1) < 0;
}

void sampleEdge(EdgeInfo& info, const TopoDS_Face& face1, const TopoDS_Face& face2, double side) {
  const TopoDS_Edge use1 = useInFace(info.edge, face1);
  const TopoDS_Edge use2 = useInFace(info.edge, face2);
  if (use1.IsNull() || use2.IsNull()) return;
  const BRepAdaptor_Curve curve(info.edge);
  const double direction = use1.Orientation() == TopAbs_REVERSED ? -1 : 1;
  for (int i = 0; i < kEdgeSamples; ++i) {
    const double share = static_cast<double>(i) / (kEdgeSamples - 1);
    EdgeSample s;
    s.t = curve.FirstParameter() + share * (curve.LastParameter() - curve.FirstParameter());
    curve.D1(s.t, s.point, s.tangent);
    const std::optional<gp_Vec> n1 = normalAlong(use1, face1, share);
    std::optional<gp_Vec> n2 = normalAlong(use2, face2, share);
    if (!n1 || !n2 || s.tangent.Magnitude() < 1e-12) continue;
    s.tangent.Normalize();
    if (n1->Angle(*n2) > M_PI - kKnife) {
      const gp_Vec inward = direction * n1->Crossed(s.tangent);
      const bool convex = isBetween(s.point, kBeside * GCPnts_AbscissaPoint::Length(curve) * inward,
                                    *n1, face1, face2);
      // So that all agree on the half that the pipe turns through.
      *n2 += kTilt * (convex ? -inward : inward);
    }
    // Both the normals and the sense of "convex" turn with the side.
    s.angle = side * std::atan2(direction * n1->Crossed(*n2).Dot(s.tangent), n1->Dot(*n2));
    s.n1 = *n1 * side;
    s.n2 = *n2 * side;
    info.samples.push_back(s);
  }
}

std::vector<std::vector<int>> edgesAtVertices(const EdgeTable& table) {
  std::vector<std::vector<int>> result(static_cast<std::size_t>(table.vertexIndex.Extent()));
  for (std::size_t e = 0; e < table.edges.size(); ++e) {
    TopoDS_Vertex ends[2];
    TopExp::Vertices(table.edges[e].edge, ends[0], ends[1]);
    for (int k = 0; k < 2; ++k) {
      if (ends[k].IsNull() || (k == 1 && ends[1].IsSame(ends[0]))) continue;
      result[static_cast<std::size_t>(table.vertexIndex.FindIndex(ends[k]) - 1)].push_back(
          static_cast<int>(e));
    }
  }
  return result;
}

}  // namespace

EdgeTable makeEdgeTable(const TopoDS_Shape& shape, double side, double smoothAngle) {
  EdgeTable table;
  TopExp::MapShapes(shape, TopAbs_FACE, table.faceIndex);
  TopExp::MapShapes(shape, TopAbs_EDGE, table.edgeIndex);
  TopExp::MapShapes(shape, TopAbs_VERTEX, table.vertexIndex);
  for (int i = 1; i <= table.faceIndex.Extent(); ++i) {
    table.faces.push_back(TopoDS::Face(table.faceIndex(i)));
  }
  TopTools_IndexedDataMapOfShapeListOfShape facesOfEdge;
  TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, facesOfEdge);

  for (int i = 1; i <= table.edgeIndex.Extent(); ++i) {
    EdgeInfo info;
    info.edge = TopoDS::Edge(table.edgeIndex(i).Oriented(TopAbs_FORWARD));
    const TopTools_ListOfShape& users = facesOfEdge.FindFromKey(table.edgeIndex(i));
    std::vector<int> faces;
    for (const TopoDS_Shape& user : users) faces.push_back(table.faceIndex.FindIndex(user) - 1);
    if (!faces.empty()) info.face1 = faces[0];
    if (faces.size() > 1) info.face2 = faces[1];
    if (faces.size() > 2) ++table.nonManifold;
    const bool seam = info.face1 == info.face2;
    if (!BRep_Tool::Degenerated(info.edge) && info.face2 >= 0 && !seam && faces.size() == 2) {
      sampleEdge(info, table.faces[static_cast<std::size_t>(info.face1)],
                 table.faces[static_cast<std::size_t>(info.face2)], side);
    }
    double convex = 0;
    for (const EdgeSample& s : info.samples) {
      info.largestAngle = std::max(info.largestAngle, std::abs(s.angle));
      convex = std::max(convex, s.angle);
    }
    info.smooth = !info.samples.empty() && info.largestAngle < smoothAngle;
    info.pipe = convex >= smoothAngle;
    table.edges.push_back(info);
  }
  table.edgesAt = edgesAtVertices(table);
  return table;
}

}  // namespace phront::cad
