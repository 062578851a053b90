// Models as bytes, to cross a process border.
#pragma once

#include <string>
#include <string_view>

#include "phront/cad/shape.h"
#include "phront/status.h"

namespace phront::cad {

[[nodiscard]] std::string bytesOfModel(const Model& model);
[[nodiscard]] Result<Model> modelOfBytes(std::string_view bytes);

}  // namespace phront::cad
