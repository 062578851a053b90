// phi decides: which patches and which of their pieces lie on the offset.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <gp_Pnt.hxx>
#include <gp_Pnt2d.hxx>
#include <gp_Vec.hxx>
#include <vector>

#include "tessellate/true_distance.h"

namespace phront::cad {

struct FaceSample {
  gp_Pnt point;
  gp_Vec normal;  ///< of the oriented face
};

struct JudgedFace {
  TopoDS_Face face;
  std::vector<FaceSample> samples;  ///< inside the face; empty: no point was found
  double deviation = 0;             ///< mm, median of |phi - d| over the samples
  double largest = 0;               ///< mm, largest |phi - d| over the samples
  double level = 0;                 ///< mm, median of phi
  bool live = false;
  bool mixed = false;  ///< some samples on the offset, some not
};

/// Points inside the face: one by OpenCASCADE, others on parameter lines.
[[nodiscard]] std::vector<FaceSample> interiorSamples(const TopoDS_Face& face);

/// Parameters of a grid inside the face, about `pitch` (mm) apart: 10 to 48 per direction.
[[nodiscard]] std::vector<gp_Pnt2d> gridInside(const TopoDS_Face& face, double pitch);

/// Live pieces: the median sample has |phi - d| <= tolerance. Sheets: the foot must not lie on a
/// free edge.
[[nodiscard]] std::vector<JudgedFace> judgeFaces(const std::vector<TopoDS_Face>& faces, bool solid,
                                                 double distance, double tolerance,
                                                 const TrueDistance& phi);

/// Edges that live pieces use otherwise than twice; degenerated ones aside.
[[nodiscard]] std::vector<TopoDS_Edge> openEdges(const std::vector<JudgedFace>& faces);

/// True when the 1-Lipschitz bound proves that no point of the patch is within `tolerance` of the
/// level d. Never true for a patch with a live point.
[[nodiscard]] bool provenDead(const TopoDS_Face& face, double distance, double tolerance,
                              const TrueDistance& phi);

/// True when phi grows along `normal` at the sample.
[[nodiscard]] bool facesOutward(const FaceSample& sample, const gp_Vec& normal, double step,
                                const TrueDistance& phi);

}  // namespace phront::cad
