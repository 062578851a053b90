// Weak spot: cells are boxes of sampled points with a margin; what bulges out of it between the
// samples could be missed, which the check of the result would show.
#include "rebuild/contact_cells.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <queue>

#include "rebuild/surface_cells.h"
#include "tessellate/face_surface.h"

namespace phront::cad {
namespace {

constexpr int kEdgeCells = 32;
constexpr std::size_t kFaceCells = 128;

}  // namespace

const ContactCells::Cells& ContactCells::ofEdge(int key, const TopoDS_Edge& edge) {
  const auto [it, isNew] = known_.try_emplace(key);
  Cells& cells = it->second;
  if (!isNew || BRep_Tool::Degenerated(edge)) return cells;
  const BRepAdaptor_Curve curve(edge);
  const double t0 = curve.FirstParameter();
  const double step = (curve.LastParameter() - t0) / kEdgeCells;
  for (int i = 0; i < kEdgeCells; ++i) {
    Box3 box;
    for (const double share : {0.0, 0.5, 1.0})
      box.extend(toVec3(curve.Value(t0 + (i + share) * step).XYZ()));
    cells.cells.push_back(
        grown(box, kBulge * box.diagonal().norm() + BRep_Tool::Tolerance(edge) + gap_));
    cells.box.extend(cells.cells.back());
  }
  return cells;
}

const ContactCells::Cells& ContactCells::ofFace(int key, const TopoDS_Face& face) {
  const auto [it, isNew] = known_.try_emplace(key);
  Cells& cells = it->second;
  if (!isNew) return cells;
  const BRepAdaptor_Surface surface(face, Standard_False);
  double u0 = 0;
  double u1 = 0;
  double v0 = 0;
  double v1 = 0;
  BRepTools::UVBounds(face, u0, u1, v0, v1);
  std::priority_queue<SurfaceCell> open;
  open.push(surfaceCell(surface, u0, u1, v0, v1));
  while (open.size() < kFaceCells) {
    const SurfaceCell largest = open.top();
    open.pop();
    for (const SurfaceCell& half : halves(surface, largest)) open.push(half);
  }
  for (; !open.empty(); open.pop()) {
    const Box3& box = open.top().box;
    cells.cells.push_back(
        grown(box, kBulge * box.diagonal().norm() + BRep_Tool::Tolerance(face) + gap_));
    cells.box.extend(cells.cells.back());
  }
  return cells;
}

bool ContactCells::meet(const Cells& a, const Cells& b) {
  if (!a.box.intersects(b.box)) return false;
  for (const Box3& cell : a.cells) {
    if (!cell.intersects(b.box)) continue;
    for (const Box3& other : b.cells)
      if (cell.intersects(other)) return true;
  }
  return false;
}

bool ContactCells::mayTouch(int edgeKey, const TopoDS_Edge& edge, int faceKey,
                            const TopoDS_Face& face) {
  return meet(ofEdge(edgeKey, edge), ofFace(faceKey, face));
}

bool ContactCells::mayTouch(int key1, const TopoDS_Edge& edge1, int key2,
                            const TopoDS_Edge& edge2) {
  return meet(ofEdge(key1, edge1), ofEdge(key2, edge2));
}

}  // namespace phront::cad
