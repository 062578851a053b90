#include "geom/face_phi.h"

#include "base/lanes.h"

namespace phront {

PHRONT_CLONES FacePhi facePhi(const QueryTriangle& t, const NodeBlock& block,
                              const std::array<int, 3>& corner) {
  using L = Lanes<double, 4>;
  const Vec3 low = block.position(BlockQuery::nodeOf(corner, 0));
  const Vec3 high = block.position(BlockQuery::nodeOf(corner, 7));
  const std::array<double, 4> alongX{low[0], high[0], low[0], high[0]};
  const std::array<double, 4> alongY{low[1], low[1], high[1], high[1]};
  const L none{};
  FacePhi result;
  for (std::size_t layer = 0; layer < 2; ++layer) {
    std::array<L, 3> x;
    x[0] = loadLanes<L>(alongX.data());
    x[1] = loadLanes<L>(alongY.data());
    x[2] = none + (layer == 0 ? low[2] : high[2]);
    const AboveFace<L> above = aboveFace<L>(t, x);
    storeLanes(result.squared.data() + 4 * layer, above.squared);
    storeLanes(result.height.data() + 4 * layer, above.height);
    const L least = minOf<L>(minOf<L>(above.weight[0], above.weight[1]), above.weight[2]);
    for (std::size_t lane = 0; lane < 4; ++lane)
      result.over |= (least[lane] > 0 ? 1U : 0U) << (4 * layer + lane);
  }
  return result;
}

}  // namespace phront
