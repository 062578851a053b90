// Meshes from and to files: STL, OBJ, PLY; fields and meshes to VTU.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "phront/distance_field.h"
#include "phront/status.h"
#include "phront/tri_mesh.h"

namespace phront {

enum class MeshFormat { Stl, Obj, Ply, Vtu };

/// Format by extension (.stl .obj .ply .vtu, any case); InvalidArgument names the known ones.
[[nodiscard]] Result<MeshFormat> meshFormatOf(const std::filesystem::path& path);

/// Reads STL (binary or ASCII; welded by bitwise equal points), OBJ (polygons are fanned), PLY
/// (ASCII or binary little/big endian). Point and triangle order follow the file. ASCII STL solids
/// and OBJ groups become faceOf. Fails with UnreadableInput (not there, empty, cut short, NaN,
/// index out of range); never crashes on hostile input.
[[nodiscard]] Result<TriMesh> readMesh(const std::filesystem::path& path);

/// Writes binary STL, OBJ, binary PLY or VTU (faceOf as cell data). Written to a file beside it,
/// flushed, then renamed: never half a file. Fails with CannotWrite.
[[nodiscard]] Result<void> writeMesh(const TriMesh& mesh, const std::filesystem::path& path);

/// Field as unstructured points or cells of the band with phi as point data (VTU).
[[nodiscard]] Result<void> writeField(const DistanceField& field,
                                      const std::filesystem::path& path);

/// Writes `bytes` aside, then renames over `path`. The one way phront writes files.
[[nodiscard]] Result<void> writeFileAtomically(const std::filesystem::path& path,
                                               std::string_view bytes);

}  // namespace phront
