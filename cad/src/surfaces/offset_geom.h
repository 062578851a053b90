// The offset of one surface over a part of its domain.
#pragma once

#include <Geom_Surface.hxx>
#include <vector>

#include "phront/offset_nurbs.h"
#include "surfaces/nurbs_geom.h"

namespace phront::cad {

/// A piece of an offset: its point at (u,v) stems from the original's at the same (u,v).
struct OffsetPiece {
  Handle(Geom_Surface) surface;
  ParameterBox box;
  bool exact = false;  ///< closed form: same type as the original
  double error = 0;    ///< mm, largest |S_d - (S + d n)| found; 0 when exact
};

/// S + d n, n along S_u x S_v, over `box`. Planes, cylinders, cones, spheres, tori, and revolutions
/// and extrusions of lines and circles stay what they are; other revolutions and extrusions keep
/// their kind with the offset of their curve; B-splines are fitted. One piece, but several where
/// the surface has edges inside. None where the offset shrinks to a line or a point, or through it
/// (radius below |d|). `options.distance` and tolerance in mm. Fails as offsetNurbs does, and with
/// NotSupported.
[[nodiscard]] Result<std::vector<OffsetPiece>> offsetGeom(const Handle(Geom_Surface) & surface,
                                                          const ParameterBox& box,
                                                          const NurbsOffsetOptions& options);

}  // namespace phront::cad
