// Offsets of the surfaces of a model, not sewn.
#pragma once

#include <filesystem>

#include "cli.h"
#include "phront/cad/offset_surfaces.h"

namespace phront::cli {

/// CAD file out: the trimmed offset surface of every face. Returns the exit code.
int offsetSurfacesFile(const cad::Model& model, const std::filesystem::path& in,
                       const std::filesystem::path& out, const cad::SurfacesOptions& options,
                       const CommonOptions& common);

}  // namespace phront::cli
