// One attempt, step by step: heal, raw complex of exact patches, drop what is proven dead, General
// Fuse, phi decides, assemble. Each step leaves a line in the notes.
#include "rebuild/exact_offset.h"

#include <fmt/format.h>

#include <BRepCheck_Analyzer.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "heal/heal.h"
#include "patches/patch_tools.h"
#include "patches/raw_complex.h"
#include "rebuild/assemble.h"
#include "rebuild/front_cuts.h"
#include "rebuild/fuse.h"
#include "rebuild/living_cells.h"
#include "rebuild/select.h"

namespace phront::cad {
namespace {

/// Of the diagonal: how far the level of a piece may be off d. Approximated curves and pipes are
/// good to a tenth of it.
constexpr double kLevelTolerance = 1e-5;
constexpr double kApproximation = 1e-6;
/// Of |d|: pieces this near to the level are live if the rest needs them; the check allows ten
/// times as much.
constexpr double kDoubt = 5e-3;

/// Of |d|: how well lines that phi shows are met from both sides, as General Fuse's fuzzy value and
/// for sewing.
constexpr std::array kCutFuzzy{0.0, 1e-3};
constexpr double kCutSewing = 2e-3;
/// More lines than this are noise: the surfaces fold, and cutting takes long.
constexpr std::size_t kMostCuts = 80;

/// Pieces to make the offset of, and how they are sewn if they have to be, mm.
struct PieceSet {
  std::vector<JudgedFace> pieces;
  double sewTolerance = 0;
};

bool isSound(const TopoDS_Shape& shape, double size) {
  if (!BRepCheck_Analyzer(shape).IsValid()) return false;
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next())
    if (!tessellates(TopoDS::Face(it.Current()), size)) return false;
  return true;
}

}  // namespace

Result<AttemptResult> tryExactOffset(const TopoDS_Shape& body, bool solid, double distance,
                                     const TrueDistance& phi, const AttemptSetting& setting) {
  if (!std::isfinite(distance) || distance == 0) {
    return fail(ErrorCode::InvalidArgument, "the distance must be a number other than 0");
  }
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

  MayCross mayCross;
  std::optional<LivingCells> cells;
  if (setting.thinPairs) {
    cells.emplace(raw.faces, distance, levelTolerance, phi);
    mayCross = [&](std::size_t i, std::size_t j) { return cells->mayCross(i, j); };
  }
  const Result<std::vector<TopoDS_Face>> split =
      splitFaces(raw.faces, setting.fuzzy * diagonal, mayCross);
  if (!split) return tl::unexpected<Error>(split.error());
  result.splitFaces = static_cast<int>(split->size());

  const auto judgedOf = [&](const std::vector<TopoDS_Face>& pieces) {
    std::vector<JudgedFace> judged = judgeFaces(pieces, solid, distance, levelTolerance, phi);
    if (solid) {
      const int turned = settleDoubtful(judged, kDoubt * std::abs(distance));
      if (turned > 0) result.notes.push_back(fmt::format("{} doubtful pieces settled", turned));
    }
    return judged;
  };
  std::vector<JudgedFace> judged = judgedOf(*split);
  std::vector<PieceSet> sets;
  if (solid) {
    // Where phi shows that pieces leave the offset they are cut there.
    const std::vector<TopoDS_Shape> cuts = frontCuts(judged, solid, distance, levelTolerance, phi);
    for (const double share : kCutFuzzy) {
      if (cuts.empty() || cuts.size() > kMostCuts) break;
      const auto never = [](std::size_t, std::size_t) { return false; };
      const double fuzzy = std::max(setting.fuzzy * diagonal, share * std::abs(distance));
      const Result<std::vector<TopoDS_Face>> again = splitFaces(*split, fuzzy, never, cuts);
      if (!again) continue;
      sets.push_back({judgedOf(*again),
                      std::max(setting.sewTolerance * diagonal, kCutSewing * std::abs(distance))});
    }
    if (!cuts.empty()) result.notes.push_back(fmt::format("{} cuts by phi", cuts.size()));
  }
  sets.push_back({std::move(judged), setting.sewTolerance * diagonal});

  Assembly assembly;
  for (const PieceSet& set : sets) {
    const auto kept = std::count_if(set.pieces.begin(), set.pieces.end(),
                                    [](const JudgedFace& j) { return j.live; });
    if (kept == 0) continue;
    const AssembleOptions options{
        .distance = distance, .diagonal = diagonal, .sewTolerance = set.sewTolerance};
    Assembly made =
        solid ? assembleSolids(set.pieces, options, phi) : assembleSheet(set.pieces, options, phi);
    const bool better =
        assembly.shape.IsNull() || (!made.shape.IsNull() && made.openEdges < assembly.openEdges);
    if (result.keptFaces == 0 || better) {
      result.keptFaces = static_cast<int>(kept);
      assembly = std::move(made);
    }
    if (!assembly.shape.IsNull() && assembly.openEdges == 0) break;
  }
  const bool sound = !assembly.shape.IsNull() && assembly.openEdges == 0 &&
                     isSound(assembly.shape, std::abs(distance));
  if (solid && result.keptFaces > 0 && !sound) {
    // Of the cut pieces, then of the others.
    for (const PieceSet* set : {&sets.front(), &sets.back()}) {
      Assembly made = assembleWithFacets(set->pieces, {distance, diagonal, set->sewTolerance}, phi);
      if (made.shape.IsNull() || made.openEdges > 0) continue;
      assembly = std::move(made);
      break;
    }
  }
  if (result.keptFaces == 0) {
    result.notes.push_back("no piece of any patch lies on the offset");
    return result;
  }
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
