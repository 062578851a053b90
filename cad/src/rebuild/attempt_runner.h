// Runs attempts at exact patches in guarded children and lets the judge choose.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "deadline.h"
#include "judge/check_body.h"
#include "phront/cad/offset_shape.h"
#include "rebuild/exact_offset.h"
#include "tessellate/true_distance.h"

namespace phront::cad {

/// A result that was judged.
struct JudgedAttempt {
  std::vector<Body> bodies;
  std::string setting;
  double reach = 1;
  int fittedFaces = 0;
  int facetedFaces = 0;  ///< of mended ones
  FileCheck file;        ///< of its file, or of itself where there is none
};

/// Pieces of the offset that do not make a result that passes.
struct OpenPieces {
  std::string setting;
  double reach = 1;
  TopoDS_Shape pieces;
};

struct AttemptLog {
  std::optional<JudgedAttempt> accepted;
  std::optional<JudgedAttempt> rejected;  ///< the first valid, closed one that failed otherwise
  std::vector<OpenPieces> open;           ///< of the attempts on a solid that were not accepted
  std::vector<std::string> lines;         ///< one per attempt: setting, outcome, seconds
};

/// Tries the settings in order (two at a time when threads allow) until one result passes the
/// check, or the `deadline` is reached. With two at a time the earlier setting wins, so the choice
/// does not depend on who finishes first. `healed` is offset and `phi`
/// is its distance; `check` decides.
[[nodiscard]] AttemptLog runAttempts(const Body& healed, const OffsetOptions& options,
                                     const TrueDistance& phi, const BodyCheck& check,
                                     const Deadline& deadline, const Progress& progress);

/// Splits a shape into bodies: one per solid, one per connected sheet.
[[nodiscard]] std::vector<Body> bodiesOf(const TopoDS_Shape& shape, BodyKind kind,
                                         const std::string& name);

}  // namespace phront::cad
