// Mitre join: pipes and sphere patches of an offset give way to the faces beside them.
#pragma once

#include <TopoDS_Shape.hxx>

#include "deadline.h"
#include "tessellate/true_distance.h"

namespace phront::cad {

struct MitreRequest {
  double distance = 0;   ///< d, mm, signed
  double tolerance = 0;  ///< mm: how far points may leave the range [|d|, limit * |d|]
  double limit = 2;      ///< of |d|: corners that would reach farther from the part stay round
};

struct MitreJoin {
  TopoDS_Shape solid;
  int sharpened = 0;  ///< faces round edges and corners that are gone
  int rounded = 0;    ///< those that stay
};

/// Removes from `solid`, the offset of the part that `phi` is the distance of, the faces that stem
/// from edges and vertices, and extends the faces beside them until they meet. Those that hang
/// together go together; groups that cannot go, or leave what is no solid, points off the offset
/// surfaces or corners beyond the limit, stay as they are.
[[nodiscard]] MitreJoin mitreJoin(const TopoDS_Shape& solid, const MitreRequest& request,
                                  const TrueDistance& phi, const Deadline& deadline);

}  // namespace phront::cad
