// Where a patch may be on the offset: which pairs of patches need to be intersected at all.
#pragma once

#include <TopoDS_Face.hxx>
#include <vector>

#include "phront/types.h"
#include "tessellate/true_distance.h"

namespace phront::cad {

/// For a set of patches: the boxes of those of their cells that are not proven off the level d.
class LivingCells {
 public:
  /// `distance` signed, `tolerance` > 0, both mm.
  LivingCells(const std::vector<TopoDS_Face>& patches, double distance, double tolerance,
              const TrueDistance& phi);

  /// False when the two patches certainly do not cross anywhere on the level d, or meet there only
  /// along the edges that they share by construction.
  [[nodiscard]] bool mayCross(std::size_t first, std::size_t second) const;

  /// The same without faith in shared edges: true as well where patches that share an edge come
  /// near one another along it.
  [[nodiscard]] bool mayMeet(std::size_t first, std::size_t second) const;

 private:
  struct Patch {
    TopoDS_Face face;
    std::vector<Box3> cells;  ///< empty: dead all over
    Box3 box;
  };
  std::vector<Patch> patches_;
  double near_ = 0;  ///< mm, from a shared edge
};

}  // namespace phront::cad
