// The free edges of a sheet: where it ends, and which way its faces look there.
#pragma once

#include <BRepAdaptor_Curve.hxx>
#include <Geom2d_Curve.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <optional>
#include <vector>

#include "phront/types.h"

namespace phront::cad {

/// A place on a free edge. Vectors are of unit length.
struct BorderPoint {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();   ///< of the face, outward
  Vec3 tangent = Vec3::Zero();  ///< of the edge
};

/// An edge used once, by one face.
class FreeEdge {
 public:
  FreeEdge(const TopoDS_Edge& edge, const TopoDS_Face& face);

  [[nodiscard]] const TopoDS_Edge& edge() const { return edge_; }
  [[nodiscard]] const TopoDS_Face& face() const { return face_; }
  [[nodiscard]] const BRepAdaptor_Curve& curve() const { return curve_; }
  [[nodiscard]] double first() const { return curve_.FirstParameter(); }
  [[nodiscard]] double last() const { return curve_.LastParameter(); }
  /// Empty where the edge or its face is singular.
  [[nodiscard]] std::optional<BorderPoint> at(double parameter) const;

 private:
  TopoDS_Edge edge_;
  TopoDS_Face face_;
  BRepAdaptor_Curve curve_;
  Handle(Geom2d_Curve) pcurve_;
};

/// Where an edge between two faces ends at the border, and the faces turn by an angle.
struct RidgeEnd {
  Vec3 point = Vec3::Zero();
  Vec3 tangent = Vec3::Zero();  ///< of the edge, unit
  Vec3 normal1 = Vec3::Zero();  ///< of the two faces, outward, unit
  Vec3 normal2 = Vec3::Zero();
  bool convex = false;  ///< seen from the side that the normals point to
};

/// All free edges of a sheet, seams and degenerated edges aside.
class FreeBorder {
 public:
  /// `chord` (mm, > 0): how far the polygons that searches start from may be off the edges.
  FreeBorder(const TopoDS_Shape& sheet, double chord);

  [[nodiscard]] const std::vector<FreeEdge>& edges() const { return edges_; }
  [[nodiscard]] const std::vector<RidgeEnd>& ridgeEnds() const { return ridgeEnds_; }
  /// Edges with more than two faces, or with faces that do not agree which side is out.
  [[nodiscard]] int badEdges() const { return badEdges_; }

  /// Closest point of all free edges. Empty when there is none.
  [[nodiscard]] std::optional<BorderPoint> nearest(const Vec3& x) const;

 private:
  struct Segment {
    Vec3 from, to;
    double first, last;  ///< parameters
    std::size_t edge;
  };
  [[nodiscard]] double parameterNear(const Vec3& x, const Segment& segment) const;

  std::vector<FreeEdge> edges_;
  std::vector<Segment> segments_;
  std::vector<RidgeEnd> ridgeEnds_;
  int badEdges_ = 0;
};

}  // namespace phront::cad
