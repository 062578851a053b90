// Boxes along edges and over faces: which of them come near each other at all.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <map>
#include <vector>

#include "phront/types.h"

namespace phront::cad {

/// Cuts edges and faces into cells as they are asked for and keeps the cells' boxes. One box round
/// a long curved face meets most of the part; its cells do not. Keys are the caller's.
class ContactCells {
 public:
  /// `gap` (mm): what is farther apart does not touch.
  explicit ContactCells(double gap) : gap_(gap) {}

  /// False when the two certainly do not touch.
  bool mayTouch(int edgeKey, const TopoDS_Edge& edge, int faceKey, const TopoDS_Face& face);
  bool mayTouch(int key1, const TopoDS_Edge& edge1, int key2, const TopoDS_Edge& edge2);

 private:
  struct Cells {
    Box3 box;
    std::vector<Box3> cells;
  };
  const Cells& ofEdge(int key, const TopoDS_Edge& edge);
  const Cells& ofFace(int key, const TopoDS_Face& face);
  static bool meet(const Cells& a, const Cells& b);

  double gap_;
  std::map<int, Cells> known_;
};

}  // namespace phront::cad
