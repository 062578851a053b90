// Patches cut along their crossings, the pieces judged and put together.
#pragma once

#include <TopoDS_Face.hxx>
#include <optional>
#include <string>
#include <vector>

#include "phront/status.h"
#include "rebuild/assemble.h"
#include "rebuild/exact_offset.h"
#include "rebuild/fuse.h"
#include "rebuild/living_cells.h"
#include "rebuild/select.h"

namespace phront::cad {

/// The patches in pieces, and what those on the offset enclose.
struct Cut {
  std::vector<JudgedFace> judged;
  int pieces = 0;
  int kept = 0;
  Assembly assembly;
  std::vector<std::string> notes;

  [[nodiscard]] bool isClosed() const {
    return kept == 0 || (!assembly.shape.IsNull() && assembly.openEdges == 0);
  }
};

/// What a cut needs to know; all lengths mm. Methods may throw, hang or crash with OpenCASCADE.
struct Cutting {
  bool solid;
  double distance;        ///< signed
  double diagonal;        ///< of the body
  double levelTolerance;  ///< how far pieces may be off the level
  const AttemptSetting& setting;
  const TrueDistance& phi;

  /// Fails where General Fuse does, and where a sheet folds away from the offset. `fuzzy` is
  /// General Fuse's value.
  [[nodiscard]] Result<Cut> cut(const std::vector<TopoDS_Face>& patches, const MayCross& mayCross,
                                double fuzzy) const;

  /// Cuts once more, patches of open pieces with their neighbours, too; nullopt where that does not
  /// close either or takes longer than `seconds`. In a child of its own: OpenCASCADE may take for
  /// ever over patches that are tangent along an edge. Leaves `judged` empty.
  [[nodiscard]] std::optional<Cut> again(const std::vector<TopoDS_Face>& patches,
                                         const LivingCells& cells, const Cut& first,
                                         double seconds) const;
};

}  // namespace phront::cad
