// Small tools for building patches: normals, arcs, faces on parameter rectangles with shared edges.
#pragma once

#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <array>
#include <gp_Pnt.hxx>
#include <gp_Pnt2d.hxx>
#include <gp_Vec.hxx>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace phront::cad {

/// Directions closer than this (rad) count as one; OpenCASCADE's own angular tolerance is 1e-12,
/// imported models are good to about 1e-6.
inline constexpr double kAngularTolerance = 1e-6;

/// Outward unit normal of an oriented face at (u,v). At singular parameters the normal a little
/// inside the face's parameter box. Empty when there is none.
[[nodiscard]] std::optional<gp_Vec> outwardNormal(const TopoDS_Face& face, const gp_Pnt2d& uv);

/// The face's orientation-composed edges, degenerated ones included, in wire order.
[[nodiscard]] std::vector<TopoDS_Edge> edgesOf(const TopoDS_Face& face);

/// The vertex of the face's first degenerated edge; null without one.
[[nodiscard]] TopoDS_Vertex poleOf(const TopoDS_Face& face);

/// Diagonal of the bounding box.
[[nodiscard]] double diagonalOf(const TopoDS_Shape& shape);

/// Whether the face's surface is a plane, to 1e-6 of `diagonal` (mm), that of the part.
[[nodiscard]] bool isPlanar(const TopoDS_Face& face, double diagonal);

/// False when OpenCASCADE's mesher gives up on the face, for lengths of the order of `size` (mm).
[[nodiscard]] bool tessellates(const TopoDS_Face& face, double size);

/// Vertex as a point.
[[nodiscard]] TopoDS_Vertex makeVertex(const gp_Pnt& point, double tolerance);

/// Straight line from a to b in (u,v) over the parameters [first, last].
[[nodiscard]] Handle(Geom2d_Curve)
    straightPcurve(const gp_Pnt2d& a, const gp_Pnt2d& b, double first, double last);

/// Smooth curve through `points` at `parameters`, both in order and of the same number.
[[nodiscard]] Handle(Geom2d_Curve)
    pcurveThrough(const std::vector<gp_Pnt2d>& points, const std::vector<double>& parameters);

/// Vertices found by place: apices shared by the patches that end there.
class PointPool {
 public:
  TopoDS_Vertex at(const gp_Pnt& point, double tolerance);

 private:
  std::vector<TopoDS_Vertex> vertices_;
};

/// Arcs and lines between vertices, shared by every patch that ends on them.
class ArcPool {
 public:
  /// Arc of the given radius about `centre` from `from` to `to`, turning about `axis` by less than
  /// a full turn; where the two almost coincide, the short way. The same pair of vertices gives the
  /// same edge (whichever way it is asked for).
  TopoDS_Edge arc(const gp_Pnt& centre, const gp_Vec& axis, double radius,
                  const TopoDS_Vertex& from, const TopoDS_Vertex& to);

  /// Straight edge between two vertices, shared in the same way.
  TopoDS_Edge line(const TopoDS_Vertex& from, const TopoDS_Vertex& to);

 private:
  using Key = std::pair<const void*, const void*>;
  struct Entry {
    TopoDS_Edge edge;
    gp_Pnt middle;
  };
  TopoDS_Edge shared(const Handle(Geom_Curve) & curve, double last, const TopoDS_Vertex& from,
                     const TopoDS_Vertex& to);
  std::map<Key, std::vector<Entry>> arcs_;  ///< looked up only, never iterated
};

/// One side of a patch: an existing edge, and where its first and last parameter lie in (u,v).
/// A null edge asks for a new one between the two corners; `degenerated` for a pole.
struct PatchSide {
  TopoDS_Edge edge;
  gp_Pnt2d first;
  gp_Pnt2d last;
  bool degenerated = false;
  TopoDS_Vertex pole;               ///< vertex of a degenerated side
  Handle(Geom2d_Curve) curve = {};  ///< in (u,v), over the edge's range; null: straight
};

/// Face on `surface` whose wire runs through `sides` counter-clockwise in (u,v); sides whose edge
/// runs the other way are reversed. Null on failure.
[[nodiscard]] TopoDS_Face faceFromSides(const Handle(Geom_Surface) & surface,
                                        const std::vector<PatchSide>& sides, double tolerance);

}  // namespace phront::cad
