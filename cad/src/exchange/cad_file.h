// A CAD file on its way to OpenCASCADE: what is common to the reading of bodies and of wires.
#pragma once

#include <filesystem>

#include "exchange/file_text.h"
#include "exchange/load_shapes.h"
#include "exchange/step_scan.h"
#include "phront/status.h"

namespace phront::cad {

struct CadFile {
  FileText text;
  StepScan scan;  ///< of STEP
};

/// "reading NAME: why", where the trouble is the file's.
[[nodiscard]] tl::unexpected<Error> unreadable(const std::filesystem::path& path,
                                               const std::string& why);

/// Bytes that OpenCASCADE may see. Ours alone looks at them here, in the parent. Fails with
/// UnreadableInput.
[[nodiscard]] Result<CadFile> openCadFile(const std::filesystem::path& path, double memoryLimitMiB);

/// By OpenCASCADE's reader of the format; call in a guarded child.
[[nodiscard]] Result<Loaded> loadCadFile(const std::filesystem::path& path, const CadFile& file);

/// Faults of OpenCASCADE mean a damaged file here; what the scan saw may say where.
[[nodiscard]] Error explain(Error error, const std::filesystem::path& path, const CadFile& file);

}  // namespace phront::cad
