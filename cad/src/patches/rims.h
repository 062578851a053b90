// Closed rims whose pipes fold over: those of mouths narrower than the distance; and other edges
// whose pipes do.
#pragma once

#include <TopoDS_Shape.hxx>
#include <TopoDS_Vertex.hxx>
#include <cstddef>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "patches/edge_table.h"

namespace phront::cad {

/// The two vertices of a rim where the pipe round it folds nearest to the side that stays: there
/// the ridge ends at which its two halves are cut off.
struct RimTips {
  TopoDS_Vertex one;
  TopoDS_Vertex other;
  std::size_t rim = 0;  ///< its number
};

struct DividedRims {
  TopoDS_Shape shape;  ///< the input where no edge was divided
  std::vector<RimTips> tips;
};

/// Finds the closed rims, no circles, whose pipes of radius |distance| fold all along, and divides
/// their edges at the tips. `smoothAngle` as in EdgeTable. Rims with a number in `leaveOut` stay as
/// they are and have no tips; the numbers of the others do not depend on it.
[[nodiscard]] DividedRims divideRims(const TopoDS_Shape& shape, double distance, double smoothAngle,
                                     const std::set<std::size_t>& leaveOut = {});

/// Divides edges whose pipes of radius |distance| fold where they bend most, if that is inside of
/// them; those of rims that fold all along stay as they are. The input where there are none.
[[nodiscard]] TopoDS_Shape divideBends(const TopoDS_Shape& shape, double distance,
                                       double smoothAngle);

/// An edge of a rim, and whether the rim runs as it does.
struct RimEdge {
  int edge = 0;  ///< index into EdgeTable::edges
  bool forward = true;
};

/// A half of a rim, from one tip to the other.
using RimHalf = std::vector<RimEdge>;

/// Both halves, from the one tip to the other; nullopt when the pipes' edges do not lead there.
[[nodiscard]] std::optional<std::pair<RimHalf, RimHalf>> rimHalves(const EdgeTable& table,
                                                                   const RimTips& tips);

}  // namespace phront::cad
