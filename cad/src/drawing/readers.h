// Text of a drawing to chains. Run in a guarded child.
#pragma once

#include <string>
#include <vector>

#include "drawing/chain.h"
#include "exchange/load_shapes.h"
#include "phront/status.h"

namespace phront::cad {

struct RawDrawing {
  std::vector<Chain> chains;  ///< mm, y upwards
  double unitInMm = 1;
  std::vector<std::string> warnings;
};

/// `tolerance` in mm; <= 0: 1e-5 of the drawing's size. Fails with UnreadableInput.
[[nodiscard]] Result<RawDrawing> readSvg(const std::string& text, double tolerance);
[[nodiscard]] Result<RawDrawing> readDxf(const std::string& text, double tolerance);
/// Of a CAD file without faces; its curves lie in one plane.
[[nodiscard]] Result<RawDrawing> readWires(const Loaded& loaded, double tolerance);

}  // namespace phront::cad
