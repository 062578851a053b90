// A judged result on its way to a file: written aside, read back, judged again, renamed.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "phront/cad/check.h"
#include "phront/cad/offset_shape.h"
#include "phront/cad/shape.h"
#include "phront/status.h"

namespace phront::cad {

/// Judges what was read back within so many seconds.
using Recheck = std::function<Result<CheckResult>(const Model& back, double seconds)>;

struct WriteRequest {
  std::filesystem::path path;
  bool keep = false;                    ///< to `path` even if the check fails
  double timeLimit = 0;                 ///< s, of the work so far
  const std::vector<StageTime>& times;  ///< what it took
  std::size_t checkedFile = 0;          ///< fingerprint of a file's shape that was checked; 0: none
};

/// Adds to `check` what fails in the file, which is not checked again when its shape is the same as
/// was checked. Returns the path written.
[[nodiscard]] Result<std::filesystem::path> writeChecked(const Model& model,
                                                         const WriteRequest& request,
                                                         const Recheck& recheck,
                                                         CheckResult& check);

}  // namespace phront::cad
