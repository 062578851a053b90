// Offsets whose output is a mesh.
#pragma once

#include <filesystem>
#include <optional>

#include "cli.h"
#include "phront/cad/shape.h"

namespace phront::cli {

/// Mesh in, mesh out. `parametric` moves the input's own nodes; else the front phi = d is meshed
/// anew. Returns the exit code.
int offsetMeshFile(const std::filesystem::path& in, const std::filesystem::path& out,
                   double distance, bool parametric, std::optional<double> tolerance,
                   const CommonOptions& options);

/// Part in, mesh out: the same on the part's tessellation, body by body.
int offsetModelToMesh(const cad::Model& model, const std::filesystem::path& in,
                      const std::filesystem::path& out, double distance, bool parametric,
                      std::optional<double> tolerance, const CommonOptions& options);

}  // namespace phront::cli
