#include "rebuild/mend_stage.h"

#include <fmt/format.h>

#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>
#include <utility>

#include "exchange/guard.h"
#include "rebuild/assemble.h"
#include "rebuild/assembly_bytes.h"
#include "rebuild/front_stage.h"
#include "rebuild/plane_features.h"

namespace phront::cad {
namespace {

// Facets deviate by this share of the tolerance, as in facet_stage.
constexpr double kShareOfTolerance = 0.85;
// The front in the holes is refined by facets later on: what it misses elsewhere does not matter.
constexpr std::int64_t kFrontNodes = 200'000;
constexpr double kCreaseTolerance = 0.1;  // of |d|
// Share of the time left for the front and for each set of pieces, and bounds in seconds.
constexpr double kFrontShare = 0.3;
constexpr double kShare = 0.5;
constexpr double kLastShare = 0.7;  // the check still wants its time
constexpr double kLeastSeconds = 5;
constexpr double kLeastMendSeconds = 12;
constexpr double kMostSeconds = 30;
constexpr double kCheckSeconds = 30;
constexpr double kMemoryMiB = 3000;
constexpr std::size_t kMostTries = 2;

}  // namespace

std::optional<JudgedAttempt> mendPieces(const std::vector<OpenPieces>& open,
                                        const std::string& name, const OffsetOptions& options,
                                        const TrueDistance& phi, const BodyCheck& check,
                                        const Deadline& deadline, const Progress& progress,
                                        std::vector<std::string>& log) {
  if (open.empty()) return std::nullopt;
  FrontBounds bounds;
  bounds.nodes = kFrontNodes;
  bounds.seconds = deadline.forStep(kFrontShare, kLeastSeconds, kMostSeconds);
  bounds.creaseTolerance = kCreaseTolerance * std::abs(options.distance);
  const Result<IsoSurface> front =
      makeFront(phi.surface(), options.distance, options.threads, bounds, progress);
  if (!front) {
    log.push_back("mended: " + front.error().message);
    return std::nullopt;
  }
  std::optional<JudgedAttempt> closest;
  const double diagonal = phi.surface().box().diagonal().norm();
  const std::size_t tries = std::min(open.size(), kMostTries);
  for (std::size_t i = 0; i < tries; ++i) {
    const double share = i + 1 < tries ? kShare : kLastShare;
    const auto start = std::chrono::steady_clock::now();
    const auto say = [&](const std::string& outcome) {
      log.push_back(
          fmt::format("{} mended: {} ({:.1f} s)", open[i].setting, outcome, secondsSince(start)));
    };
    if (i > 0 && deadline.left() < kLeastSeconds) break;
    const double level = open[i].reach * options.distance;
    FacetGapOptions facets;
    facets.distance = level;
    facets.tolerance = kShareOfTolerance * *options.tolerance;
    facets.planeOfFace = planesOf(phi.tessellation().features);
    const AssembleOptions assembling{.distance = level, .diagonal = diagonal};
    const Result<std::string> bytes = runInChild(
        "mending the pieces",
        {deadline.forStep(share, kLeastMendSeconds, kMostSeconds), kMemoryMiB},
        [&]() -> Result<std::string> {
          std::vector<TopoDS_Face> pieces;
          for (TopExp_Explorer it(open[i].pieces, TopAbs_FACE); it.More(); it.Next())
            pieces.push_back(TopoDS::Face(it.Current()));
          const Result<Assembly> made = assembleWithFacets(pieces, assembling, facets, *front, phi);
          if (!made) return tl::unexpected(made.error());
          return bytesOfAssembly(*made);
        });
    if (!bytes) {
      say(bytes.error().message);
      continue;
    }
    const Result<Assembly> made = assemblyOfBytes(*bytes);
    if (!made) {
      say(made.error().message);
      continue;
    }
    JudgedAttempt judged;
    judged.setting = open[i].setting;
    judged.reach = open[i].reach;
    judged.facetedFaces = made->facetedFaces;
    judged.bodies = bodiesOf(made->shape, BodyKind::Solid, name);
    judged.file =
        check.fromFile(judged.bodies, options, deadline.forStep(1, kLeastSeconds, kCheckSeconds));
    const CheckResult& verdict = judged.file.check;
    say(fmt::format("{}; {} facets",
                    verdict.pass() ? "accepted" : "rejected: " + verdict.reasons.front(),
                    judged.facetedFaces));
    const bool passes = verdict.pass();
    if (passes || !closest) closest = std::move(judged);
    if (passes) break;
    if (!progress.report(static_cast<double>(i + 1) / kMostTries)) break;
  }
  return closest;
}

}  // namespace phront::cad
