#include "exchange/cad_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace phront::cad {

tl::unexpected<Error> unreadable(const std::filesystem::path& path, const std::string& why) {
  return fail(ErrorCode::UnreadableInput,
              fmt::format("reading {}: {}", path.filename().string(), why), path.string());
}

Result<CadFile> openCadFile(const std::filesystem::path& path, double memoryLimitMiB) {
  auto text = loadFile(path, static_cast<std::size_t>(std::min(memoryLimitMiB, 1e6) * (1 << 20)));
  if (!text) return tl::unexpected<Error>(text.error());
  CadFile file{std::move(*text), {}};
  std::optional<std::string> defect;
  if (file.text.format == ShapeFormat::Step) {
    file.scan = scanStep(file.text.bytes);
    if (!file.scan.defect.empty()) defect = file.scan.defect;
  } else if (file.text.format == ShapeFormat::Iges) {
    defect = igesDefect(file.text.bytes);
  } else if (!file.text.binaryBrep) {
    defect = brepDefect(file.text.bytes);
  }
  if (defect) return unreadable(path, *defect);
  return file;
}

Result<Loaded> loadCadFile(const std::filesystem::path& path, const CadFile& file) {
  switch (file.text.format) {
    case ShapeFormat::Step:
      return loadStep(file.text, file.scan);
    case ShapeFormat::Iges:
      return loadIges(path);
    case ShapeFormat::Brep:
      return loadBrep(file.text);
  }
  return fail(ErrorCode::UnreadableInput, "its format is not known");
}

Error explain(Error error, const std::filesystem::path& path, const CadFile& file) {
  if (error.code == ErrorCode::Failed) {
    error.code = ErrorCode::UnreadableInput;
    error.message += "; the file is probably damaged";
  }
  if (!file.scan.suspicion.empty()) error.message += " (" + file.scan.suspicion + ")";
  if (error.where.empty()) error.where = path.string();
  return error;
}

}  // namespace phront::cad
