// One attempt, step by step: heal, raw complex of exact patches, drop what is proven dead, General
// Fuse, phi decides, assemble. Each step leaves a line in the notes.
#include "rebuild/exact_offset.h"

#include <fmt/format.h>

#include <BRep_Builder.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "deadline.h"
#include "heal/heal.h"
#include "patches/patch_tools.h"
#include "patches/raw_complex.h"
#include "patches/rims.h"
#include "rebuild/cut_patches.h"
#include "rebuild/fuse.h"
#include "rebuild/living_cells.h"
#include "rebuild/select.h"

namespace phront::cad {
namespace {

/// Of the diagonal: how far the level of a piece may be off d. Approximated curves and pipes are
/// good to a tenth of it.
constexpr double kLevelTolerance = 1e-5;
constexpr double kApproximation = 1e-6;
/// s, and times what was spent before it.
constexpr double kLeastSecondLook = 5;
constexpr double kSecondLook = 1.5;
constexpr double kShareOfFirstLook = 0.5;  // with less it is not begun: it cuts all once more
/// s of the attempt's time, kept for handing over what there is.
constexpr double kToReturn = 2;

using Clock = std::chrono::steady_clock;

TopoDS_Shape livePieces(const std::vector<JudgedFace>& judged) {
  const BRep_Builder builder;
  TopoDS_Compound pieces;
  builder.MakeCompound(pieces);
  for (const JudgedFace& piece : judged)
    if (piece.live) builder.Add(pieces, piece.face);
  return pieces;
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

  if (setting.dividesBends) {
    const TopoDS_Shape divided = divideBends(healed.shape, distance, setting.smoothTolerance);
    if (divided.IsSame(healed.shape))
      return fail(ErrorCode::Failed, "no pipe folds inside of an edge");
    healed.shape = divided;
  }
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
  if (solid) result.pieces = livePieces(cut->judged);
  if (solid && setting.looksAgain && !cut->isClosed() && cells) {
    const double spent = secondsSince(start);
    const double seconds = std::min(std::max(kLeastSecondLook, kSecondLook * spent),
                                    setting.timeLimit - spent - kToReturn);
    if (seconds > kShareOfFirstLook * spent) {
      if (std::optional<Cut> again = cutting.again(raw.faces, *cells, *cut, seconds))
        cut = std::move(*again);
    }
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
  result.shape = assembly.shape;
  if (result.shape.IsNull()) {
    result.fault = fmt::format("{} of {} pieces lie on the offset but enclose nothing",
                               result.keptFaces, result.splitFaces);
    return result;
  }
  if (solid && result.openEdges > 0) {
    result.fault = fmt::format("{} of {} pieces lie on the offset, {} edges stay open",
                               result.keptFaces, result.splitFaces, result.openEdges);
    result.shape.Nullify();
    return result;
  }
  result.notes.push_back(fmt::format("{} patches, {} pieces, {} on the offset, closed from {}",
                                     result.rawFaces, result.splitFaces, result.keptFaces,
                                     assembly.way));
  return result;
}

}  // namespace phront::cad
