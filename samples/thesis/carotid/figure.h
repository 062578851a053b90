// The vessel with its wall and its boundary layer as a picture.
#pragma once

#include <filesystem>
#include <string>

#include "carotid/schemes.h"

namespace thesis {

/// The vessel as it was beside the vessel cut open along its branches. Without software GL the
/// picture is left out, and said so.
void drawVessel(const std::string& name, const phront::TriMesh& mesh, const Run& run,
                const std::filesystem::path& png);

}  // namespace thesis
