// A look at the text of a STEP file before OpenCASCADE sees it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace phront::cad {

struct StepScan {
  std::string defect;     ///< why OpenCASCADE must not see the file; empty: it may
  std::string suspicion;  ///< what probably explains a failure of OpenCASCADE
  std::vector<std::string> warnings;
  std::vector<std::string> externalFiles;  ///< other files that hold the geometry
  bool endLineMissing = false;             ///< END-ISO-10303-21 must be appended
  int entities = 0;
  int faces = 0;
  std::string unit = "mm";  ///< of the first geometric context
  double unitInMm = 1;
};

/// Linear in the size of the text; never throws on hostile input but std::bad_alloc.
[[nodiscard]] StepScan scanStep(std::string_view text);

}  // namespace phront::cad
