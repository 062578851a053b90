// A face that is singular at a vertex has no normal there, but it has one at either end of its
// degenerated edge. Where those differ (apex of a cone, tip of a triangular freeform patch) the
// offset surface passes the vertex along a curve from one to the other, and each of the two edges
// that meet there has an image of the vertex of its own. A pole with the same normal all round
// (sphere) is a point of the offset, too; nothing needs to be bound there.
#include "patches/vertex_images.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <optional>
#include <set>

#include "patches/patch_tools.h"

namespace phront::cad {
namespace {

/// One end of an edge of a face.
struct EdgeEnd {
  TopoDS_Vertex vertex;
  gp_Pnt2d uv;
};

std::vector<EdgeEnd> endsOf(const TopoDS_Edge& edge, const TopoDS_Face& face) {
  double t0 = 0;
  double t1 = 0;
  const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, t0, t1);
  TopoDS_Vertex first;
  TopoDS_Vertex last;
  TopExp::Vertices(edge, first, last);
  std::vector<EdgeEnd> ends;
  if (curve.IsNull()) return ends;
  if (!first.IsNull()) ends.push_back({first, curve->Value(t0)});
  if (!last.IsNull()) ends.push_back({last, curve->Value(t1)});
  return ends;
}

}  // namespace

VertexImages::VertexImages(const EdgeTable& table, double distance, double smoothAngle)
    : table_(table) {
  Corners corners;
  for (std::size_t f = 0; f < table.faces.size(); ++f)
    addCorners(static_cast<int>(f), smoothAngle, corners);
  for (const auto& [v, at] : corners) makeImages(v, at, distance, smoothAngle);
}

/// Normals of a face at its vertices: one for each, one for each side of an open pole, none at
/// other poles.
void VertexImages::addCorners(int f, double smoothAngle, Corners& corners) {
  const TopoDS_Face& face = table_.faces[static_cast<std::size_t>(f)];
  const std::vector<TopoDS_Edge> edges = edgesOf(face);
  for (const TopoDS_Edge& edge : edges)
    if (BRep_Tool::Degenerated(edge)) findPole(f, edge, smoothAngle);

  const BRepAdaptor_Surface surface(face, Standard_False);
  std::set<int> singular;
  std::map<std::pair<int, int>, Corner> found;  // by vertex and edge
  for (const TopoDS_Edge& edge : edges) {
    const int e = table_.edgeIndex.FindIndex(edge) - 1;
    for (const EdgeEnd& end : endsOf(edge, face)) {
      const int v = table_.vertexIndex.FindIndex(end.vertex) - 1;
      const OpenPole* pole = poleAt(end.vertex, f);
      const std::optional<gp_Vec> normal = outwardNormal(face, end.uv);
      if (pole != nullptr) {
        if (!normal || (e != pole->side1 && e != pole->side2)) continue;
        found.try_emplace({v, e}, Corner{f, e, *normal, BRep_Tool::Pnt(end.vertex)});
        continue;
      }
      if (BRep_Tool::Degenerated(edge) || !normal) {
        singular.insert(v);
        continue;
      }
      found.try_emplace({v, kAnyEdge},
                        Corner{f, kAnyEdge, *normal, surface.Value(end.uv.X(), end.uv.Y())});
    }
  }
  for (const auto& [key, corner] : found)
    if (!singular.contains(key.first)) corners[key.first].push_back(corner);
}

void VertexImages::findPole(int f, const TopoDS_Edge& degenerated, double smoothAngle) {
  const TopoDS_Face& face = table_.faces[static_cast<std::size_t>(f)];
  const std::vector<EdgeEnd> ends = endsOf(degenerated, face);
  if (ends.size() != 2 || poleAt(ends[0].vertex, f) != nullptr) return;
  const std::optional<gp_Vec> n0 = outwardNormal(face, ends[0].uv);
  const std::optional<gp_Vec> n1 = outwardNormal(face, ends[1].uv);
  if (!n0 || !n1 || n0->Angle(*n1) < smoothAngle) return;
  OpenPole pole{table_.edgeIndex.FindIndex(degenerated) - 1,
                table_.vertexIndex.FindIndex(ends[0].vertex) - 1, f, -1, -1};
  int sides = 0;
  for (const TopoDS_Edge& edge : edgesOf(face)) {
    if (BRep_Tool::Degenerated(edge)) continue;
    for (const EdgeEnd& end : endsOf(edge, face)) {
      if (!end.vertex.IsSame(ends[0].vertex)) continue;
      (sides == 0 ? pole.side1 : pole.side2) = table_.edgeIndex.FindIndex(edge) - 1;
      ++sides;
    }
  }
  if (sides == 2 && pole.side1 != pole.side2) poles_.push_back(pole);
}

void VertexImages::makeImages(int vertex, const std::vector<Corner>& corners, double distance,
                              double smoothAngle) {
  // Clusters of agreeing normals, by single linkage in face order.
  std::vector<int> cluster(corners.size(), -1);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (cluster[i] >= 0) continue;
    cluster[i] = static_cast<int>(i);
    std::vector<std::size_t> open{i};
    while (!open.empty()) {
      const std::size_t a = open.back();
      open.pop_back();
      for (std::size_t b = 0; b < corners.size(); ++b) {
        if (cluster[b] < 0 && corners[a].normal.Angle(corners[b].normal) < smoothAngle) {
          cluster[b] = static_cast<int>(i);
          open.push_back(b);
        }
      }
    }
    gp_XYZ sum(0, 0, 0);
    int count = 0;
    const auto target = [&](const Corner& c) { return c.point.Translated(c.normal * distance); };
    for (std::size_t b = 0; b < corners.size(); ++b) {
      if (cluster[b] != static_cast<int>(i)) continue;
      sum += target(corners[b]).XYZ();
      ++count;
    }
    const gp_Pnt mean(sum / count);
    double spread = 0;
    for (std::size_t b = 0; b < corners.size(); ++b) {
      if (cluster[b] == static_cast<int>(i))
        spread = std::max(spread, mean.Distance(target(corners[b])));
    }
    const TopoDS_Vertex image = makeVertex(mean, std::max(1.1 * spread, Precision::Confusion()));
    for (std::size_t b = 0; b < corners.size(); ++b) {
      if (cluster[b] == static_cast<int>(i))
        images_[{vertex, corners[b].face, corners[b].edge}] = image;
    }
  }
}

TopoDS_Vertex VertexImages::image(int vertex, int face, int edge) const {
  auto it = images_.find({vertex, face, edge});
  if (it == images_.end()) it = images_.find({vertex, face, kAnyEdge});
  return it == images_.end() ? TopoDS_Vertex() : it->second;
}

TopoDS_Vertex VertexImages::image(const TopoDS_Vertex& vertex, int face, int edge) const {
  return image(table_.vertexIndex.FindIndex(vertex) - 1, face, edge);
}

const OpenPole* VertexImages::poleAt(const TopoDS_Vertex& vertex, int face) const {
  const int v = table_.vertexIndex.FindIndex(vertex) - 1;
  const auto it = std::find_if(poles_.begin(), poles_.end(), [&](const OpenPole& pole) {
    return pole.vertex == v && pole.face == face;
  });
  return it == poles_.end() ? nullptr : &*it;
}

}  // namespace phront::cad
