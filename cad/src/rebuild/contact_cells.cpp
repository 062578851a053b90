// Weak spot: cells are boxes of sampled points with a margin; what bulges out of it between the
// samples could be missed, which the check of the result would show.
#include "rebuild/contact_cells.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <algorithm>
#include <queue>

namespace phront::cad {
namespace {

constexpr int kEdgeCells = 32;
constexpr std::size_t kFaceCells = 128;
// What bulges between the sample points of a cell, in parts of its size.
constexpr double kBulge = 0.15;

Vec3 toVec(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }

Box3 grown(const Box3& box, double by) {
  const Vec3 margin = Vec3::Constant(by);
  return Box3(box.min() - margin, box.max() + margin);
}

struct Cell {
  double u0, u1, v0, v1;
  Box3 box;
  double size = 0;
  bool operator<(const Cell& other) const { return size < other.size; }
};

Cell makeCell(const BRepAdaptor_Surface& surface, double u0, double u1, double v0, double v1) {
  Cell cell{u0, u1, v0, v1, {}, 0};
  for (const double u : {u0, (u0 + u1) / 2, u1}) {
    for (const double v : {v0, (v0 + v1) / 2, v1}) cell.box.extend(toVec(surface.Value(u, v)));
  }
  cell.size = cell.box.diagonal().norm();
  return cell;
}

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
      box.extend(toVec(curve.Value(t0 + (i + share) * step)));
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
  std::priority_queue<Cell> open;
  open.push(makeCell(surface, u0, u1, v0, v1));
  while (open.size() < kFaceCells) {
    const Cell c = open.top();
    open.pop();
    const double u = (c.u0 + c.u1) / 2;
    const double v = (c.v0 + c.v1) / 2;
    const double sizeU = surface.Value(c.u0, v).Distance(surface.Value(c.u1, v));
    const double sizeV = surface.Value(u, c.v0).Distance(surface.Value(u, c.v1));
    const bool acrossU = sizeU > sizeV;
    open.push(makeCell(surface, c.u0, acrossU ? u : c.u1, c.v0, acrossU ? c.v1 : v));
    open.push(makeCell(surface, acrossU ? u : c.u0, c.u1, acrossU ? c.v0 : v, c.v1));
  }
  for (; !open.empty(); open.pop()) {
    const Cell& c = open.top();
    cells.cells.push_back(grown(c.box, kBulge * c.size + BRep_Tool::Tolerance(face) + gap_));
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
