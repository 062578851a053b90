// From pieces that lie on the offset to solids and sheets.
#pragma once

#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "rebuild/facet_gaps.h"
#include "rebuild/select.h"
#include "tessellate/true_distance.h"

namespace phront::cad {

struct AssembleOptions {
  double distance = 0;      ///< mm, signed
  double diagonal = 0;      ///< mm
  double sewTolerance = 0;  ///< mm; 0: no sewing
};

struct Assembly {
  TopoDS_Shape shape;    ///< null when no solid came out
  int openEdges = 0;     ///< edges not used exactly twice in their shell
  int fittedFaces = 0;   ///< patches that close gaps
  int facetedFaces = 0;  ///< facets in holes, but for offsets of planes
  std::string way;  ///< "sharp pieces", "pieces", "sewn pieces", "patched pieces", "cells", ...
};

/// Solids bounded by the live pieces; tried in turn: without pieces narrower than their edges are
/// known, as they are, sewn, with fitted patches in their gaps, and the cells that all pieces (dead
/// ones too) divide space into. The first that closes wins, else the one with the fewest open
/// edges.
[[nodiscard]] Assembly assembleSolids(const std::vector<JudgedFace>& faces,
                                      const AssembleOptions& options, const TrueDistance& phi);

/// The last way: pieces at fault and gaps give way to facets of the front, see facetGaps(). Fails
/// when that does not close. May throw, hang or crash with OpenCASCADE.
[[nodiscard]] Result<Assembly> assembleWithFacets(const std::vector<TopoDS_Face>& pieces,
                                                  const AssembleOptions& options,
                                                  const FacetGapOptions& facets,
                                                  const IsoSurface& front, const TrueDistance& phi);

/// Live pieces sewn, facing along (d > 0) the normals of the input.
[[nodiscard]] Assembly assembleSheet(const std::vector<JudgedFace>& faces,
                                     const AssembleOptions& options, const TrueDistance& phi);

}  // namespace phront::cad
