// Planes, cylinders, cones, spheres and tori that are stored as freeform surfaces become what they
// are, and so do planes and cylinders that are stored as cones; lines and circles between them,
// too.
#pragma once

#include <BRepAdaptor_Surface.hxx>
#include <TopoDS_Shape.hxx>

namespace phront::cad {

/// A plane, cylinder, sphere, torus, or a cone that is neither almost a plane nor almost a
/// cylinder.
[[nodiscard]] bool isElementary(const BRepAdaptor_Surface& surface);

struct CanonicalShape {
  TopoDS_Shape shape;    ///< the input itself when nothing was recognised
  int faces = 0;         ///< faces recognised
  int edges = 0;         ///< edges that became lines or circles
  double deviation = 0;  ///< mm, largest distance between an old and a new surface
};

/// Recognises every face that lies on one of the five surfaces within `tolerance` (mm, > 0). An
/// edge becomes a line or circle only when all its faces are such surfaces. Edges and vertices keep
/// their neighbours: closed stays closed. A face whose new form would be invalid or of another area
/// is left as it is. May throw, hang or crash with OpenCASCADE: call it in runInChild.
[[nodiscard]] CanonicalShape recogniseSurfaces(const TopoDS_Shape& shape, double tolerance);

}  // namespace phront::cad
