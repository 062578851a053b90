// The domain of a face as a face in the plane, where it can be cut without looking at space.
#pragma once

#include <Geom_Surface.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <vector>

#include "phront/status.h"
#include "surfaces/contour.h"
#include "surfaces/nurbs_geom.h"

namespace phront::cad {

/// The plane holds (u, v), each times a scale that makes lengths about those on the surface.
class ParameterPlane {
 public:
  ParameterPlane(double scaleU, double scaleV) : scale_(scaleU, scaleV) {}

  [[nodiscard]] Vec2 toPlane(const Vec2& uv) const { return uv.cwiseProduct(scale_); }
  [[nodiscard]] Vec2 fromPlane(const Vec2& x) const { return x.cwiseQuotient(scale_); }
  [[nodiscard]] const Vec2& scale() const { return scale_; }

  /// The face's loops, FORWARD. Fails with Failed when they do not close.
  [[nodiscard]] Result<TopoDS_Face> domainOf(const TopoDS_Face& face) const;

  /// Curves along the lines, smooth between corners, to within `chord`.
  [[nodiscard]] static std::vector<TopoDS_Edge> edgesAlong(const std::vector<Contour>& lines,
                                                           double chord);
  [[nodiscard]] TopoDS_Edge edgeBetween(const Vec2& a, const Vec2& b) const;  ///< (u, v) corners

  /// The pieces of a domain between edges. Fails with Failed.
  [[nodiscard]] static Result<std::vector<TopoDS_Face>> split(
      const TopoDS_Face& domain, const std::vector<TopoDS_Edge>& edges);

  /// A face on a surface with a domain's loops, curves in space to within `tolerance`.
  [[nodiscard]] Result<TopoDS_Face> onSurface(const TopoDS_Face& domain,
                                              const Handle(Geom_Surface) & surface,
                                              double tolerance) const;

  /// Edges on a surface, with curves in space to within `tolerance`; those that get none are left
  /// out.
  [[nodiscard]] std::vector<TopoDS_Edge> onSurface(const std::vector<TopoDS_Edge>& flatEdges,
                                                   const Handle(Geom_Surface) & surface,
                                                   double tolerance) const;

 private:
  Vec2 scale_;
};

}  // namespace phront::cad
