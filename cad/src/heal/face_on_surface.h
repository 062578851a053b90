// A face of the same outline on another surface.
#pragma once

#include <GeomAdaptor_Surface.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <gp_Pnt2d.hxx>
#include <map>

namespace phront::cad {

/// New edges (forward) by the TShape of those they stand for.
using RenewedEdges = std::map<const void*, TopoDS_Edge>;

/// Parameters of the point's foot on a plane, cylinder, cone, sphere or torus.
[[nodiscard]] gp_Pnt2d parametersOn(const GeomAdaptor_Surface& surface, const gp_Pnt& p);

/// Is the surface a cone with its apex within `tolerance` of p?
[[nodiscard]] bool isApex(const GeomAdaptor_Surface& surface, const gp_Pnt& p, double tolerance);

/// The wires of `old` (as a forward face) on a plane, cylinder, cone, sphere or torus that it lies
/// on within `tolerance` (mm), turned where `turned`. Edges get parameter curves, or stand-ins from
/// `edges`; degenerated ones go, but for the apex of a cone. Throws Standard_Failure where an edge
/// runs through a pole or across the seam.
[[nodiscard]] TopoDS_Face faceOnSurface(const TopoDS_Face& old,
                                        const Handle(Geom_Surface) & surface, bool turned,
                                        const RenewedEdges& edges, double tolerance);

}  // namespace phront::cad
