// Closest points on exact trimmed faces and edges, started from their triangles.
#pragma once

#include <BRepAdaptor_Curve.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <memory>
#include <optional>
#include <vector>

#include "tessellate/face_surface.h"

namespace phront::cad {

/// A closest point on an edge.
struct EdgeFoot {
  double distance = std::numeric_limits<double>::infinity();
  Vec3 point = Vec3::Zero();
  double parameter = 0;
  Index edge = kNone;
  Index vertex = kNone;  ///< when the foot is an end of the edge
};

/// One edge: its exact curve and its polygon.
class ExactEdge {
 public:
  struct Segment {
    Vec3 from, to;
    double first = 0;  ///< curve parameters
    double last = 0;
  };

  ExactEdge(const TopoDS_Edge& edge, Index number, Index firstVertex, Index lastVertex);
  /// Takes the polygon and measures how far the curve leaves it.
  void setSegments(std::vector<Segment> segments);

  [[nodiscard]] bool usable() const { return curve_ && !segments_.empty(); }
  [[nodiscard]] bool straight() const { return straight_; }
  [[nodiscard]] double chord() const { return chord_; }          ///< largest, polygon to curve
  [[nodiscard]] double tolerance() const { return tolerance_; }  ///< of the B-Rep edge
  [[nodiscard]] const Box3& box() const { return box_; }         ///< of the polygon

  /// Nearest segment and its distance.
  [[nodiscard]] std::pair<double, std::size_t> nearestSegment(const Vec3& x) const;
  /// Local foot on the exact curve, from a segment.
  [[nodiscard]] EdgeFoot foot(const Vec3& x, std::size_t segment) const;
  /// Derivative of the curve.
  [[nodiscard]] Vec3 tangent(double parameter) const;

 private:
  [[nodiscard]] EdgeFoot newton(const Vec3& x, double parameter) const;

  std::optional<BRepAdaptor_Curve> curve_;
  std::vector<Segment> segments_;
  Box3 box_;
  Index number_ = kNone;
  Index firstVertex_ = kNone;
  Index lastVertex_ = kNone;
  double first_ = 0;
  double last_ = 0;
  double tolerance_ = 0;
  double chord_ = 0;
  bool straight_ = false;
};

/// One face: its surface and its border edges.
class TrimmedFace {
 public:
  /// `border`: numbers of its edges, seams and degenerated ones left out.
  TrimmedFace(const TopoDS_Face& face, std::vector<Index> border);

  [[nodiscard]] const FaceSurface& surface() const { return surface_; }
  [[nodiscard]] const std::vector<Index>& border() const { return border_; }
  [[nodiscard]] bool hasBorder(Index edge) const;

  /// Does the trimmed domain hold these parameters? Its border counts as inside.
  [[nodiscard]] bool contains(const Eigen::Vector2d& uv) const;

 private:
  TopoDS_Face face_;
  FaceSurface surface_;
  std::vector<Index> border_;
  mutable std::unique_ptr<BRepTopAdaptor_FClass2d> domain_;  ///< made when first asked
};

}  // namespace phront::cad
