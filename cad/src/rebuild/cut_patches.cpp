// The second look: a pipe that turns back into itself crosses its neighbours along the edges it
// shares with them, where patches otherwise only touch and are not intersected.
#include "rebuild/cut_patches.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <string_view>
#include <utility>

#include "exchange/guard.h"
#include "rebuild/assembly_bytes.h"
#include "rebuild/folds.h"
#include "rebuild/open_patches.h"
#include "rebuild/repair.h"
#include "rebuild/settle.h"

namespace phront::cad {
namespace {

/// Of the diagonal: without any General Fuse loses crossings that begin on an edge shared by both.
constexpr double kSecondFuzzy = 2e-8;
constexpr double kChildMemoryMiB = 2000;
/// Of a sheet's area: with more of it folded the check, which is dear on such faces, cannot pass.
constexpr double kMostOffFront = 0.02;

bool anyPair(std::size_t count, const MayCross& holds) {
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count; ++j)
      if (holds(i, j)) return true;
  return false;
}

}  // namespace

Result<Cut> Cutting::cut(const std::vector<TopoDS_Face>& patches, const MayCross& mayCross,
                         double fuzzy) const {
  const Result<std::vector<TopoDS_Face>> split = splitFaces(patches, fuzzy, mayCross);
  if (!split) return tl::unexpected<Error>(split.error());
  Cut cut;
  const auto judgedOf = [&](const std::vector<TopoDS_Face>& pieces) {
    std::vector<JudgedFace> judged = judgeFaces(pieces, solid, distance, levelTolerance, phi);
    const int turned = solid ? settleDoubtful(judged, distance) : 0;
    if (turned > 0) cut.notes.push_back(fmt::format("{} doubtful pieces settled", turned));
    return judged;
  };
  cut.judged = judgedOf(*split);
  cut.pieces = static_cast<int>(cut.judged.size());
  cut.kept = static_cast<int>(std::count_if(cut.judged.begin(), cut.judged.end(),
                                            [](const JudgedFace& piece) { return piece.live; }));
  if (cut.kept == 0) return cut;
  const AssembleOptions options{
      .distance = distance, .diagonal = diagonal, .sewTolerance = setting.sewTolerance * diagonal};
  if (!solid) {
    const double off = shareOffFront(cut.judged, distance, phi);
    if (off > kMostOffFront)
      return fail(ErrorCode::Failed,
                  fmt::format("{:.2g} % of the sheet folds away from the offset", 100 * off));
    cut.assembly = assembleSheet(cut.judged, options, phi);
  } else if (setting.repairSeconds == 0) {
    cut.assembly = assembleSolids(cut.judged, options, phi);
  } else {
    const RepairRequest request{options, fuzzy, levelTolerance, judgedOf};
    Result<Assembly> repaired =
        repairPieces(cut.judged, request, phi, {setting.repairSeconds, kChildMemoryMiB});
    if (repaired) cut.assembly = std::move(*repaired);
  }
  return cut;
}

std::optional<Cut> Cutting::again(const std::vector<TopoDS_Face>& patches, const LivingCells& cells,
                                  const Cut& first, double seconds) const {
  const std::vector<bool> open = openPatches(patches, first.judged);
  const MayCross isDoubtful = [&](std::size_t i, std::size_t j) {
    return open[i] && open[j] && !cells.mayCross(i, j) && cells.mayMeet(i, j);
  };
  if (!anyPair(patches.size(), isDoubtful)) return std::nullopt;
  const MayCross mayCross = [&](std::size_t i, std::size_t j) {
    return cells.mayCross(i, j) || isDoubtful(i, j);
  };
  const double fuzzy = std::max(setting.fuzzy, kSecondFuzzy) * diagonal;
  const Result<std::string> bytes =
      runInChild("a second look", {seconds, kChildMemoryMiB}, [&]() -> Result<std::string> {
        const Result<Cut> cut = this->cut(patches, mayCross, fuzzy);
        if (!cut) return tl::unexpected(cut.error());
        if (cut->kept == 0 || !cut->isClosed())
          return fail(ErrorCode::Failed, "the pieces do not close");
        return fmt::format("{} {}\n", cut->pieces, cut->kept) + bytesOfAssembly(cut->assembly);
      });
  if (!bytes) return std::nullopt;
  const std::size_t end = bytes->find('\n');
  Result<Assembly> assembly = assemblyOfBytes(std::string_view(*bytes).substr(end + 1));
  if (!assembly) return std::nullopt;
  Cut cut;
  std::istringstream(bytes->substr(0, end)) >> cut.pieces >> cut.kept;
  cut.assembly = std::move(*assembly);
  cut.notes.push_back("patches of open pieces intersected with their neighbours, too");
  return cut;
}

}  // namespace phront::cad
