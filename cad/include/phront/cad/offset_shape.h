// The main job: a model in, its offset out, judged.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "phront/cad/check.h"
#include "phront/cad/shape.h"
#include "phront/progress.h"
#include "phront/status.h"

namespace phront::cad {

struct OffsetOptions {
  double distance = 0;  ///< d, mm, signed: positive grows the solid, negative shrinks it
  /// mm, bound on the deviation; default 1 % of |d|
  std::optional<double> tolerance = std::nullopt;
  Join join = Join::Arc;            ///< mitre: of exact solids; sheets and facets stay round
  double mitreLimit = kMitreLimit;  ///< > 1
  int threads = 0;                  ///< 0: all cores
  /// s, > 0: all bodies and their checks together, shared out among attempts, mending, facets and
  /// checks. Mending and facets of a body may take 20 s more; writing and reading back come on top.
  /// What is not done by then is given up, with a sentence.
  double timeLimit = 75;
};

/// How the faces of a body's offset came about. Exact: on offset surfaces, exact or fitted;
/// Faceted: some or all faces are planar triangles in place of curved ones.
enum class OffsetKind { Exact, Faceted, Empty, Failed };

struct BodyReport {
  std::string name;
  OffsetKind kind = OffsetKind::Failed;
  int inputFaces = 0;
  int exactFaces = 0;    ///< result faces on exact offset surfaces
  int fittedFaces = 0;   ///< result faces fitted: in gaps, or freeform ones of sheets
  int facetedFaces = 0;  ///< planar facets that stand in for curved offset surfaces
  int roundedFaces = 0;  ///< mitre join: faces left round, all of them on facets and sheets
  int solids = 0;        ///< result solids
  std::string setting;   ///< which attempt the judge accepted
  double reach = 1;  ///< share of the distance it was made at: less where parts touch or cut badly
  std::vector<std::string> attempts;  ///< one line each: setting, outcome, seconds
  CheckResult check;
  std::size_t checkedFile = 0;  ///< fingerprint of the file's shape that `check` is of; 0: of none
};

struct StageTime {
  std::string stage;
  double seconds = 0;
};

struct OffsetReport {
  OffsetOptions options;           ///< as resolved
  std::vector<BodyReport> bodies;  ///< one for each body or group of bodies offset together
  CheckResult check;               ///< of the whole result against the whole input
  std::vector<std::string> warnings;
  std::vector<StageTime> times;
};

struct OffsetResult {
  Model model;  ///< no bodies when the offset is empty
  OffsetReport report;
  [[nodiscard]] bool accepted() const { return report.check.pass(); }
};

/// Offsets every body on its own, but growing solids that touch or come nearer than 2d to each
/// other together: the offset of the whole is their union. Solids give closed solids (or nothing,
/// when thinner than 2|d| everywhere); sheets give one sheet at signed distance d on the side of
/// their normals. Always judged; a result that fails its judge is still returned, `accepted()` is
/// then false. Fails with InvalidArgument, UnreadableInput (a part that cannot be measured, or is
/// not valid and has no offset that passes), Failed, ResourceLimit, Cancelled.
[[nodiscard]] Result<OffsetResult> offsetModel(const Model& model, const OffsetOptions& options,
                                               const Progress& progress = {});

/// Writes the result beside `path`, reads it back as any other program would, and checks what was
/// read; only then renames it to `path`. A result that fails (report.check then says why) goes to
/// `path` with `keep`, else to rejectedPath(path). Nothing is written for an empty offset.
/// Returns the path written, empty for none. Fails with CannotWrite.
[[nodiscard]] Result<std::filesystem::path> writeOffset(const Model& in, OffsetResult& result,
                                                        const std::filesystem::path& path,
                                                        bool keep);

/// part.step -> part.rejected.step
[[nodiscard]] std::filesystem::path rejectedPath(const std::filesystem::path& path);

}  // namespace phront::cad
