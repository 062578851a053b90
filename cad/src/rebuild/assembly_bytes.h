// Assemblies as bytes, on their way from a child process.
#pragma once

#include <string>
#include <string_view>

#include "phront/status.h"
#include "rebuild/assemble.h"

namespace phront::cad {

[[nodiscard]] std::string bytesOfAssembly(const Assembly& assembly);

/// Fails with Failed on anything else.
[[nodiscard]] Result<Assembly> assemblyOfBytes(std::string_view bytes);

}  // namespace phront::cad
