// A tessellation as bytes, to cross a process border.
#pragma once

#include <string>
#include <string_view>

#include "phront/cad/tessellate.h"
#include "phront/status.h"

namespace phront::cad {

[[nodiscard]] std::string bytesOfTessellation(const Tessellation& tessellation);
[[nodiscard]] Result<Tessellation> tessellationOfBytes(std::string_view bytes);

}  // namespace phront::cad
