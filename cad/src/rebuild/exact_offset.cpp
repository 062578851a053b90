// One attempt, step by step: heal, raw complex of exact patches, drop what is proven dead, General
// Fuse, phi decides, assemble. Each step leaves a line in the notes.
#include "rebuild/exact_offset.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include "exchange/guard.h"
#include "heal/heal.h"
#include "patches/patch_tools.h"
#include "patches/raw_complex.h"
#include "rebuild/assemble.h"
#include "rebuild/assembly_bytes.h"
#include "rebuild/folds.h"
#include "rebuild/fuse.h"
#include "rebuild/living_cells.h"
#include "rebuild/open_patches.h"
#include "rebuild/repair.h"
#include "rebuild/select.h"
#include "rebuild/settle.h"

namespace phront::cad {
namespace {

/// Of the diagonal: how far the level of a piece may be off d. Approximated curves and pipes are
/// good to a tenth of it.
constexpr double kLevelTolerance = 1e-5;
constexpr double kApproximation = 1e-6;
/// Of the diagonal: without any General Fuse loses crossings that begin on an edge shared by both.
constexpr double kSecondFuzzy = 2e-8;
/// s, and times what was spent before it.
constexpr double kLeastSecondLook = 5;
constexpr double kSecondLook = 1.5;
constexpr double kRepairMemoryMiB = 2000;
/// Of a sheet's area: with more of it folded the check, which is dear on such faces, cannot pass.
constexpr double kMostOffFront = 0.02;

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

bool anyPair(std::size_t count, const MayCross& holds) {
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count; ++j)
      if (holds(i, j)) return true;
  return false;
}

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

struct Cutting {
  bool solid;
  double distance;
  double diagonal;
  double levelTolerance;
  const AttemptSetting& setting;
  const TrueDistance& phi;

  /// `fuzzy` mm.
  [[nodiscard]] Result<Cut> cut(const std::vector<TopoDS_Face>& patches, const MayCross& mayCross,
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
    const AssembleOptions options{.distance = distance,
                                  .diagonal = diagonal,
                                  .sewTolerance = setting.sewTolerance * diagonal};
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
          repairPieces(cut.judged, request, phi, {setting.repairSeconds, kRepairMemoryMiB});
      if (repaired) cut.assembly = std::move(*repaired);
    }
    return cut;
  }
};

/// Cuts once more, patches of open pieces with their neighbours, too; nullopt where that leaves as
/// little closed or takes longer than `seconds`. In a child of its own: OpenCASCADE may take for
/// ever over patches that are tangent along an edge.
std::optional<Cut> secondLook(const std::vector<TopoDS_Face>& patches, const LivingCells& cells,
                              const Cutting& cutting, const Cut& first, double seconds) {
  const std::vector<bool> open = openPatches(patches, first.judged);
  const MayCross isDoubtful = [&](std::size_t i, std::size_t j) {
    return open[i] && open[j] && !cells.mayCross(i, j) && cells.mayMeet(i, j);
  };
  if (!anyPair(patches.size(), isDoubtful)) return std::nullopt;
  const MayCross mayCross = [&](std::size_t i, std::size_t j) {
    return cells.mayCross(i, j) || isDoubtful(i, j);
  };
  const double fuzzy = std::max(cutting.setting.fuzzy, kSecondFuzzy) * cutting.diagonal;
  const Result<std::string> bytes =
      runInChild("a second look", {seconds, kRepairMemoryMiB}, [&]() -> Result<std::string> {
        const Result<Cut> cut = cutting.cut(patches, mayCross, fuzzy);
        if (!cut) return tl::unexpected(cut.error());
        if (!cut->isClosed()) return fail(ErrorCode::Failed, "the pieces do not close");
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

}  // namespace

Result<AttemptResult> tryExactOffset(const TopoDS_Shape& body, bool solid, double distance,
                                     const TrueDistance& phi, const AttemptSetting& setting) {
  if (!std::isfinite(distance) || distance == 0) {
    return fail(ErrorCode::InvalidArgument, "the distance must be a number other than 0");
  }
  const Clock::time_point start = Clock::now();
  AttemptResult result;
  const double diagonal = diagonalOf(body);
  HealedShape healed = heal(body, {.tolerance = 1e-5 * diagonal, .unify = setting.unifyInput});
  result.notes = std::move(healed.notes);

  RawComplex raw = buildRawComplex(healed.shape, {.distance = distance,
                                                  .smoothAngle = setting.smoothTolerance,
                                                  .tolerance = kApproximation * diagonal});
  result.notes.insert(result.notes.end(), raw.notes.begin(), raw.notes.end());
  result.rawFaces = static_cast<int>(raw.faces.size());

  const double levelTolerance = kLevelTolerance * diagonal;
  if (setting.dropDeadPatches) {
    const auto dead = [&](const TopoDS_Face& f) {
      return provenDead(f, distance, 10 * levelTolerance, phi);
    };
    const auto end = std::remove_if(raw.faces.begin(), raw.faces.end(), dead);
    const auto count = raw.faces.end() - end;
    raw.faces.erase(end, raw.faces.end());
    if (count > 0) result.notes.push_back(fmt::format("{} patches proven dead", count));
  }

  std::optional<LivingCells> cells;
  MayCross mayCross;
  if (setting.thinPairs) {
    cells.emplace(raw.faces, distance, levelTolerance, phi);
    mayCross = [&](std::size_t i, std::size_t j) { return cells->mayCross(i, j); };
  }
  const Cutting cutting{solid, distance, diagonal, levelTolerance, setting, phi};
  Result<Cut> cut = cutting.cut(raw.faces, mayCross, setting.fuzzy * diagonal);
  if (!cut) return tl::unexpected<Error>(cut.error());
  if (solid && setting.looksAgain && !cut->isClosed() && cells) {
    const double seconds = std::max(kLeastSecondLook, kSecondLook * secondsSince(start));
    if (std::optional<Cut> again = secondLook(raw.faces, *cells, cutting, *cut, seconds))
      cut = std::move(*again);
  }
  result.splitFaces = cut->pieces;
  result.keptFaces = cut->kept;
  result.notes.insert(result.notes.end(), cut->notes.begin(), cut->notes.end());
  if (result.keptFaces == 0) {
    result.notes.push_back("no piece of any patch lies on the offset");
    return result;
  }
  const Assembly& assembly = cut->assembly;
  result.openEdges = assembly.openEdges;
  result.fittedFaces = assembly.fittedFaces;
  result.facetedFaces = assembly.facetedFaces;
  result.shape = assembly.shape;
  if (result.shape.IsNull()) {
    return fail(ErrorCode::Failed,
                fmt::format("{} of {} pieces lie on the offset but enclose nothing",
                            result.keptFaces, result.splitFaces));
  }
  if (solid && result.openEdges > 0) {
    return fail(ErrorCode::Failed,
                fmt::format("{} of {} pieces lie on the offset, {} edges stay open",
                            result.keptFaces, result.splitFaces, result.openEdges));
  }
  result.notes.push_back(fmt::format("{} patches, {} pieces, {} on the offset, closed from {}",
                                     result.rawFaces, result.splitFaces, result.keptFaces,
                                     assembly.way));
  return result;
}

}  // namespace phront::cad
