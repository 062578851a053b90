// STEP, IGES and BREP in and out.
#pragma once

#include <filesystem>
#include <optional>

#include "phront/cad/shape.h"
#include "phront/status.h"

namespace phront::cad {

enum class ShapeFormat { Step, Iges, Brep };

/// Format by extension (.step .stp .iges .igs .brep .brp, any case); InvalidArgument names them.
[[nodiscard]] Result<ShapeFormat> shapeFormatOf(const std::filesystem::path& path);

struct ReadOptions {
  double timeLimit = 25;      ///< seconds of the reading process; above 20 MB in proportion
  double memoryLimit = 4096;  ///< MiB of the reading process
  std::optional<double> sewTolerance = {};  ///< mm; automatic: 1e-5 of the diagonal
  double maxExtent = 1e7;                   ///< mm; larger models are refused as nonsense
  bool repair = true;  ///< false: take the shape as the file has it (for reading results back)
};

/// Reads a file in a child process with limits on time and memory, so that whatever OpenCASCADE
/// does with a hostile file (exception, signal, endless recursion, hang, output) ends as an Error.
/// The format follows the content where it is plain (a STEP file named .igs is read as STEP, with a
/// warning), else the extension. Lengths arrive in mm. Bodies are placed; Model::assemblies tells
/// how they hang together. Faces without a solid are sewn; closed shells become solids with
/// positive volume.
/// Fails with UnreadableInput or ResourceLimit, one sentence that names the trouble.
[[nodiscard]] Result<Model> readModel(const std::filesystem::path& path,
                                      const ReadOptions& options = {});

/// Writes the bodies (in mm) in a guarded child process, aside, then renames. Names, colours and
/// assemblies are kept in STEP. Fails with CannotWrite.
[[nodiscard]] Result<void> writeModel(const Model& model, const std::filesystem::path& path);

}  // namespace phront::cad
