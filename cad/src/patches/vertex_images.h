// Where the offset puts the vertices of a body.
#pragma once

#include <TopoDS_Vertex.hxx>
#include <map>
#include <tuple>
#include <vector>

#include "patches/edge_table.h"

namespace phront::cad {

/// A degenerated edge round which the normals of its face differ: the pole is a point of the body,
/// but a curve of its offset. Indices into EdgeTable.
struct OpenPole {
  int edge = -1;
  int vertex = -1;
  int face = -1;
  int side1 = -1;  ///< the face's edges that meet at the pole
  int side2 = -1;
};

/// Vertices at V + d n, one per direction: faces that agree in their normal at V share it.
class VertexImages {
 public:
  VertexImages(const EdgeTable& table, double distance, double smoothAngle);

  /// Of `vertex` as an end of `edge` in `face`; only at open poles does the edge matter. Null where
  /// the face has no normal there.
  [[nodiscard]] TopoDS_Vertex image(int vertex, int face, int edge) const;
  [[nodiscard]] TopoDS_Vertex image(const TopoDS_Vertex& vertex, int face, int edge) const;

  [[nodiscard]] const std::vector<OpenPole>& poles() const { return poles_; }
  /// Null when `vertex` is no open pole of `face`.
  [[nodiscard]] const OpenPole* poleAt(const TopoDS_Vertex& vertex, int face) const;

 private:
  static constexpr int kAnyEdge = -1;
  struct Corner {
    int face = 0;
    int edge = kAnyEdge;
    gp_Vec normal;
    gp_Pnt point;
  };
  using Corners = std::map<int, std::vector<Corner>>;  ///< by vertex

  void addCorners(int face, double smoothAngle, Corners& corners);
  void findPole(int face, const TopoDS_Edge& degenerated, double smoothAngle);
  void makeImages(int vertex, const std::vector<Corner>& corners, double distance,
                  double smoothAngle);

  const EdgeTable& table_;
  std::vector<OpenPole> poles_;
  std::map<std::tuple<int, int, int>, TopoDS_Vertex> images_;  ///< (vertex, face, edge)
};

}  // namespace phront::cad
