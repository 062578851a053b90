// Tables 4.2 and 4.3: the distance to a solid in the middle of a cube, swept on finer and finer
// grids.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "phront/tri_mesh.h"

namespace thesis {

struct PrintedErrors {
  int cells = 0;    ///< of the frame, along a side
  std::string rms;  ///< as the thesis prints them; "-": not printed
  std::string max;
};

/// Prints the table of both orders for a frame of side 0.5 and writes it to `csv`.
void distanceTable(const std::string& title, const phront::TriMesh& solid,
                   const std::vector<PrintedErrors>& printed, const std::filesystem::path& csv);

}  // namespace thesis
