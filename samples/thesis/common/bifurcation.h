// A blood vessel that forks, made up.
#pragma once

#include "phront/tri_mesh.h"

namespace thesis {

/// Wall of an artery of the size of a human carotid, mm, seen from the tissue: the flow comes from
/// below (-z) and leaves through two branches that rise in the plane y = 0. Open at the three ends,
/// which are plane. `around`: points on a ring, even; rings are about as far apart as their points.
[[nodiscard]] phront::TriMesh bifurcation(int around);

}  // namespace thesis
