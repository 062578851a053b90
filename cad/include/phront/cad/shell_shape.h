// Walls: a solid in, hollow out, with openings; a sheet in, a solid of its thickness out.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "phront/cad/offset_shape.h"
#include "phront/cad/select_faces.h"
#include "phront/cad/shape.h"
#include "phront/progress.h"
#include "phront/status.h"

namespace phront::cad {

enum class ShellSide {
  In,    ///< inside the faces, which stay; of a sheet: against its normals
  Out,   ///< outside of them: the part becomes the cavity; of a sheet: along its normals
  Both,  ///< half of the thickness on either side
};

/// A face whose wall has a thickness of its own.
struct FaceThickness {
  FaceId face;
  double thickness = 0;  ///< mm, > 0
};

struct ShellOptions {
  double thickness = 0;  ///< t, mm, > 0
  ShellSide side = ShellSide::In;
  /// Faces left open; none: a closed cavity. Planes, inwards also what moveFaces() moves.
  std::vector<FaceId> open = {};
  /// Of solids: planes, cylinders, cones, spheres, tori, as moveFaces() moves them.
  std::vector<FaceThickness> thicknessOf = {};
  /// mm, bound on the error of the thickness; default 1 % of t
  std::optional<double> tolerance = std::nullopt;
  int threads = 0;        ///< 0: all cores
  double timeLimit = 75;  ///< s, > 0: as in OffsetOptions
};

struct ShellReport {
  ShellOptions options;            ///< as resolved
  std::vector<BodyReport> bodies;  ///< one for each body; faces: of its cavity or outer side
  /// Of all bodies: accuracy is the error of the wall's thickness, coverage what a wall lacks.
  CheckResult check;
  std::vector<std::string> warnings;
  std::vector<StageTime> times;
};

struct ShellResult {
  Model model;
  ShellReport report;
  [[nodiscard]] bool accepted() const { return report.check.pass(); }
};

/// Makes the wall of every solid: all that lies within the thickness of the faces that are not
/// open, on the side wanted, and does not reach beyond an opening. Concave edges of the far side
/// are sharp, convex ones rounded (arc join), so that the thickness is the same everywhere. Behind
/// a face with a thickness of its own the far side is that of the part with the face moved. A part
/// too thin to be hollow stays as it is, with a warning. Sheets become the solids between their two
/// sides; along their free edges these end straight, along the normals. Always judged; a result
/// that fails is still returned, `accepted()` is then false. Fails with InvalidArgument,
/// NotSupported (other openings; faces that moveFaces() refuses; sheets whose faces disagree which
/// side is out), UnreadableInput, Failed, ResourceLimit, Cancelled.
[[nodiscard]] Result<ShellResult> shellModel(const Model& model, const ShellOptions& options,
                                             const Progress& progress = {});

/// Whether `out` is the shell of `in` that `options` ask for, measured: each solid of `out` belongs
/// to the body of `in` whose box is most like its own. Independent of how `out` was made. `samples`
/// on each body, options.timeLimit for all. Fails with InvalidArgument, NotSupported, Failed,
/// ResourceLimit.
[[nodiscard]] Result<CheckResult> checkShell(const Model& in, const Model& out,
                                             const ShellOptions& options, int samples = 20'000);

/// As writeOffset(): writes aside, reads back, checks what was read, renames.
[[nodiscard]] Result<std::filesystem::path> writeShell(const Model& in, ShellResult& result,
                                                       const std::filesystem::path& path,
                                                       bool keep);

}  // namespace phront::cad
