// Poles that open into a curve when their face is offset.
#pragma once

#include <TopoDS_Face.hxx>

#include "patches/vertex_images.h"

namespace phront::cad {

/// `image`: the plain offset of the face `pole.face`, with the wires of that face. Gives the
/// degenerated edge at the pole its length, and the edges beside it the ends of it.
[[nodiscard]] TopoDS_Face openPole(const EdgeTable& table, const OpenPole& pole,
                                   const VertexImages& vertices, const TopoDS_Face& image);

}  // namespace phront::cad
