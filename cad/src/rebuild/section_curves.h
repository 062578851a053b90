// Intersection curves as General Fuse has found them, before it makes edges of them.
#pragma once

#include <BOPDS_DS.hxx>
#include <IntTools_Context.hxx>

namespace phront::cad {

/// Measures every intersection curve whose tolerance is above `doubtful` (mm) against its two
/// faces: the tolerance becomes what was measured, where that is much less; parameter curves that
/// are off are left to be made anew from the curve. Where a curve leaves its faces the straight
/// line between its ends takes its place if it is short, else the pair is intersected again,
/// without approximation. Returns how many curves were changed.
int settleSectionCurves(BOPDS_DS& ds, const Handle(IntTools_Context) & context, double doubtful);

}  // namespace phront::cad
