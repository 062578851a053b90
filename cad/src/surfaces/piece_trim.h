// An offset surface cut back to the front.
#pragma once

#include <TopoDS_Face.hxx>
#include <vector>

#include "surfaces/offset_geom.h"
#include "surfaces/piece_front.h"
#include "tessellate/true_distance.h"

namespace phront::cad {

struct TrimmedPiece {
  std::vector<TopoDS_Face> faces;  ///< on the piece's surface, FORWARD
  bool whole = false;              ///< nothing was cut off
  double deviation = 0;            ///< mm, largest | |phi| - |d| | of samples of the faces
};

/// The part of the piece over the domain of `face` where the front is. Lines where it ends are
/// followed from samples of the domain and of its loops; what they leave mixed is cut again.
/// `cutAtBox`: the face reaches beyond the piece. Fails with Failed.
[[nodiscard]] Result<TrimmedPiece> trimPiece(const TopoDS_Face& face, const OffsetPiece& piece,
                                             bool cutAtBox, const TrimRequest& request,
                                             const TrueDistance& phi);

}  // namespace phront::cad
