// A face on a surface, large enough to reach what it is to meet.
#pragma once

#include <Geom_Surface.hxx>
#include <TopoDS_Face.hxx>
#include <gp_Pnt.hxx>
#include <vector>

namespace phront::cad {

/// Points along the face's edges.
[[nodiscard]] std::vector<gp_Pnt> outlineOf(const TopoDS_Face& face);

/// A rectangle in (u,v) of `surface`, which is that of `face` or one parallel to it: round the
/// images of `outline` and of `beyond`. As much of a closed surface as `face` has, or more; no
/// farther than the apex of a cone. Null on freeform surfaces.
[[nodiscard]] TopoDS_Face reachingFace(const Handle(Geom_Surface) & surface,
                                       const TopoDS_Face& face, const std::vector<gp_Pnt>& outline,
                                       const std::vector<gp_Pnt>& beyond);

}  // namespace phront::cad
