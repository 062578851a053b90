// Text in STEP files: ISO 10303-21 writes what is not ASCII as \X2\....\X0\.
#pragma once

#include <string>
#include <string_view>

namespace phront::cad {

/// UTF-8 to the encoding of STEP; control characters become spaces, bad bytes question marks.
/// Quotes stay single: OpenCASCADE's writer doubles them.
[[nodiscard]] std::string stepString(std::string_view utf8);

/// Back to UTF-8, from \X2\, \X4\, \X\ and \S\ directives; what is malformed stays as it is.
[[nodiscard]] std::string textOfStepString(std::string_view encoded);

}  // namespace phront::cad
