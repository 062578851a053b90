// How an edge bends beside its two faces.
#pragma once

#include <BRepAdaptor_Curve.hxx>
#include <gp_Vec.hxx>
#include <optional>
#include <vector>

#include "patches/edge_table.h"

namespace phront::cad {

/// The normals of the two faces and the curvature of an edge.
struct Bend {
  gp_Vec n1;
  gp_Vec n2;
  gp_Vec curvature;  ///< 1/mm, towards the centre of curvature
};

/// `curve` is that of the edge, which has at least two samples; nullopt where it has no tangent.
[[nodiscard]] std::optional<Bend> bendAt(const EdgeInfo& info, const BRepAdaptor_Curve& curve,
                                         double t);

/// Where inside an edge, no circle, the pipe of `radius` (mm, > 0) round it folds and the edge
/// bends most: shares of its parameters, in order. The pipe passes through itself from there on.
[[nodiscard]] std::vector<double> tightBends(const EdgeInfo& info, double radius);

}  // namespace phront::cad
