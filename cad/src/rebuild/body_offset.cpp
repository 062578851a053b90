#include "rebuild/body_offset.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "deadline.h"
#include "exchange/guard.h"
#include "exchange/shape_bytes.h"
#include "heal/heal.h"
#include "judge/check_body.h"
#include "patches/patch_tools.h"
#include "phront/cad/shape_occt.h"
#include "phront/cad/tessellate.h"
#include "phront/iso_surface.h"
#include "rebuild/attempt_runner.h"
#include "rebuild/facet_stage.h"
#include "rebuild/front_stage.h"
#include "rebuild/mend_stage.h"
#include "rebuild/mitre_join.h"
#include "rebuild/sheet_stage.h"
#include "tessellate/body_distance.h"
#include "tessellate/true_distance.h"

namespace phront::cad {
namespace {

using Clock = std::chrono::steady_clock;

// How far a recognised plane, cylinder, ... may lie from the freeform face it stands for: of the
// diagonal, and of |d|, so that it spends little of the tolerance.
constexpr double kRecognitionOfDiagonal = 2e-6;
constexpr double kRecognitionOfDistance = 1e-3;
constexpr double kRecognitionSeconds = 10;
constexpr double kRecognitionMemoryMiB = 2000;
// Shares of the time left: attempts where facets can follow, where nothing can, and where trimmed
// faces can.
constexpr double kAttemptShare = 0.55;
constexpr double kOnlyAttemptsShare = 0.9;
constexpr double kSheetAttemptShare = 0.35;
constexpr double kTessellateShare = 0.3;
constexpr double kMostTessellateSeconds = 45;
constexpr double kFrontShare = 0.25;
// Facets come last, when little time is left: seconds on top of it, and the share of these and what
// is left that mending may take.
constexpr double kExtraSeconds = 20;
constexpr double kMendShare = 0.6;
// The part's triangles are so much finer for facets than for exact patches: they have nothing
// truer.
constexpr double kFineness = 2;
// Bounds of the seconds for one measurement of the result.
constexpr double kLeastSeconds = 3;
constexpr double kCheckSeconds = 40;
constexpr double kLeastMitreSeconds = 10;
// Nodes up to which the front is refined for thin features where it decides that nothing is left.
constexpr std::int64_t kEmptyNodes = 2'500'000;

class StageClock {
 public:
  explicit StageClock(std::vector<StageTime>& times) : times_(times), start_(Clock::now()) {}
  void lap(const std::string& stage) {
    const Clock::time_point now = Clock::now();
    times_.push_back({stage, std::chrono::duration<double>(now - start_).count()});
    start_ = now;
  }

 private:
  std::vector<StageTime>& times_;
  Clock::time_point start_;
};

/// The body with elementary surfaces where it has freeform ones that are the same: what the offset
/// is made from. It is judged against the body as read.
Body withElementarySurfaces(const Body& body, double distance, std::vector<std::string>& log) {
  const double tolerance = std::min(kRecognitionOfDiagonal * diagonalOf(occtShape(body.shape)),
                                    kRecognitionOfDistance * std::abs(distance));
  const Result<std::string> bytes =
      runInChild("recognising surfaces", {kRecognitionSeconds, kRecognitionMemoryMiB},
                 [&]() -> Result<std::string> {
                   const HealedShape healed = makeElementary(occtShape(body.shape), tolerance);
                   if (healed.notes.empty()) return std::string();
                   return healed.notes.front() + "\n" + bytesOfShape(healed.shape);
                 });
  if (!bytes) {
    log.push_back(bytes.error().message);
    return body;
  }
  if (bytes->empty()) return body;
  const std::size_t end = bytes->find('\n');
  const Result<TopoDS_Shape> shape = shapeOfBytes(std::string_view(*bytes).substr(end + 1));
  if (!shape) return body;
  log.push_back(bytes->substr(0, end));
  Body healed = body;
  healed.shape = makeShape(*shape);
  healed.faceNames.clear();
  return healed;
}

// The front, refined only where it decides whether anything is left.
Result<IsoSurface> frontOf(const TrueDistance& phi, const OffsetOptions& options,
                           const Deadline& deadline, const Progress& progress) {
  const Deadline end(kFrontShare * deadline.left());
  Result<IsoSurface> front =
      makeFront(phi.surface(), options.distance, options.threads, {0, end.left()}, progress);
  if (!front || !front->mesh.triangles.empty() || !front->unresolved) return front;
  return makeFront(phi.surface(), options.distance, options.threads, {kEmptyNodes, end.left()},
                   progress);
}

/// One body on its way: each step takes its share of the time that is left.
class BodyOffsetter {
 public:
  BodyOffsetter(const Body& body, const OffsetOptions& options, const Progress& progress)
      : body_(body),
        wanted_(options),
        options_(withArcs(options)),
        progress_(progress),
        deadline_(options.timeLimit),
        clock_(result_.times) {
    result_.report.name = body.name;
    result_.report.inputFaces = faceCount(body.shape);
  }

  Result<BodyOffset> run() {
    if (!progress_.part(0, 0.1, "tessellate").report(0)) return cancelled();
    const Body healed = withElementarySurfaces(body_, options_.distance, report().attempts);
    clock_.lap("heal");
    const auto tessellating = [&] {
      return deadline_.forStep(kTessellateShare, kLeastSeconds, kMostTessellateSeconds);
    };
    Result<TrueDistance> made = distanceOf(healed, options_.distance, tessellating());
    if (!made) return tl::unexpected(made.error());
    const auto phi = std::make_shared<const TrueDistance>(std::move(*made));
    Result<BodyCheck> check =
        BodyCheck::make(body_, healed, phi, options_.distance, tessellating());
    if (!check) return tl::unexpected(check.error());
    check_ = std::move(*check);
    clock_.lap("tessellate");

    bool facetsMayFollow = body_.kind == BodyKind::Solid && phi->surface().closed();
    // Inwards nothing may be left, which the front knows soonest.
    if (facetsMayFollow && options_.distance < 0) {
      const Result<bool> empty = seemsEmpty(*phi);
      if (!empty) return tl::unexpected(empty.error());
      if (*empty) {
        if (provenEmpty()) return std::move(result_);
        facetsMayFollow = false;  // a rest thinner than the grid: exact patches may still find it
      }
    }
    if (tryExact(healed, *phi, facetsMayFollow)) {
      if (wanted_.join == Join::Mitre && body_.kind == BodyKind::Solid) {
        if (!progress_.part(0.8, 1, "mitre").report(0)) return cancelled();
        makeMitre(*phi);
      }
      return finish();
    }
    if (facetsMayFollow) {
      if (Result<void> found = useFront(healed, *phi); !found) return tl::unexpected(found.error());
    } else if (body_.kind == BodyKind::Sheet) {
      if (Result<void> found = useTrimmedFaces(healed, *phi); !found)
        return tl::unexpected(found.error());
    } else {
      report().check =
          failedCheck(report().attempts.empty()
                          ? "no way gave a result"
                          : "no attempt gave a result that passes: " + report().attempts.back());
    }
    // Better a result that fails its check, marked as such, than none.
    if (result_.bodies.empty() && attempts_.rejected)
      useAttempt(std::move(*attempts_.rejected), OffsetKind::Failed);
    return finish();
  }

 private:
  BodyReport& report() { return result_.report; }

  static Result<BodyOffset> cancelled() {
    return fail(ErrorCode::Cancelled, "the offset was cancelled");
  }

  Result<BodyOffset> finish() {
    report().solids = report().check.solids;
    if (wanted_.join == Join::Mitre && !mitreTried_ && !result_.bodies.empty())
      report().roundedFaces = report().check.faces;  // facets and sheets
    return std::move(result_);
  }

  /// True when the front says so.
  Result<bool> seemsEmpty(const TrueDistance& phi) {
    const Result<IsoSurface> front =
        frontOf(phi, options_, deadline_, progress_.part(0.1, 0.3, "front"));
    clock_.lap("front");
    if (front) return front->mesh.triangles.empty();
    if (front.error().code == ErrorCode::Cancelled) return tl::unexpected(front.error());
    report().attempts.push_back(front.error().message);
    return false;
  }

  bool provenEmpty() {
    const CheckResult check =
        check_->inMemory({}, options_, deadline_.forStep(1, kLeastSeconds, kCheckSeconds));
    clock_.lap("check");
    if (!check.pass()) return false;
    report().kind = OffsetKind::Empty;
    report().check = check;
    return true;
  }

  /// True when an attempt is accepted.
  bool tryExact(const Body& healed, const TrueDistance& phi, bool facetsMayFollow) {
    const bool sheet = body_.kind == BodyKind::Sheet;
    const double share = sheet             ? kSheetAttemptShare
                         : facetsMayFollow ? kAttemptShare
                                           : kOnlyAttemptsShare;
    attempts_ = runAttempts(healed, options_, phi, *check_, Deadline(share * deadline_.left()),
                            progress_.part(0.3, 0.7, "exact patches"));
    clock_.lap("exact patches");
    report().attempts.insert(report().attempts.end(), attempts_.lines.begin(),
                             attempts_.lines.end());
    if (attempts_.accepted) useAttempt(std::move(*attempts_.accepted), OffsetKind::Exact);
    return attempts_.accepted.has_value();
  }

  /// Exact pieces with facets of the front where they fail; else facets alone.
  Result<void> useFront(const Body& healed, const TrueDistance& phi) {
    const Deadline deadline(deadline_.left() + kExtraSeconds);
    const Result<TrueDistance> finer = finerDistance(healed, deadline);
    const TrueDistance& distance = finer ? *finer : phi;
    std::optional<JudgedAttempt> mended =
        mendPieces(attempts_.open, body_.name, options_, distance, *check_,
                   Deadline(kMendShare * deadline.left()), progress_.part(0.7, 0.8, "mending"),
                   report().attempts);
    clock_.lap("mending");
    if (mended && mended->file.check.pass()) {
      useAttempt(std::move(*mended), OffsetKind::Faceted);
      return {};
    }
    if (Result<void> found = useFacets(healed, distance, deadline); !found) return found;
    // Of two that fail the one that is exact but in places.
    if (!report().check.pass() && mended && mended->file.check.valid && mended->file.check.closed)
      useAttempt(std::move(*mended), OffsetKind::Failed);
    return {};
  }

  void useAttempt(JudgedAttempt attempt, OffsetKind kind) {
    result_.bodies = std::move(attempt.bodies);
    report().kind = kind;
    report().setting = attempt.setting;
    report().reach = attempt.reach;
    report().check = std::move(attempt.file.check);
    report().checkedFile = attempt.file.fingerprint;
    report().fittedFaces = attempt.fittedFaces;
    report().facetedFaces = attempt.facetedFaces;
    report().exactFaces = report().check.faces - report().fittedFaces - report().facetedFaces;
  }

  /// Corners become sharp where that passes the check; else they stay round.
  void makeMitre(const TrueDistance& phi) {
    mitreTried_ = true;
    const Deadline deadline(std::max(deadline_.left(), kLeastMitreSeconds));
    const MitreRequest request{options_.distance, *options_.tolerance, wanted_.mitreLimit};
    std::vector<Body> sharp = result_.bodies;
    int sharpened = 0;
    int rounded = 0;
    for (Body& body : sharp) {
      const MitreJoin join = mitreJoin(occtShape(body.shape), request, phi, deadline);
      body.shape = makeShape(join.solid);
      sharpened += join.sharpened;
      rounded += join.rounded;
    }
    clock_.lap("mitre");
    report().roundedFaces = sharpened + rounded;
    if (sharpened == 0) return;
    FileCheck file = check_->fromFile(sharp, wanted_, kCheckSeconds);
    clock_.lap("check");
    if (!file.check.pass()) {
      report().attempts.push_back("mitre: rejected: " + file.check.reasons.front());
      return;
    }
    report().attempts.push_back(fmt::format(
        "mitre: accepted; {} faces round edges and corners removed, {} stay", sharpened, rounded));
    result_.bodies = std::move(sharp);
    report().roundedFaces = rounded;
    report().check = std::move(file.check);
    report().checkedFile = file.fingerprint;
    report().exactFaces = report().check.faces - report().fittedFaces - report().facetedFaces;
  }

  Result<TrueDistance> finerDistance(const Body& healed, const Deadline& deadline) {
    const double seconds =
        deadline.forStep(kTessellateShare, kLeastSeconds, kMostTessellateSeconds);
    Result<TrueDistance> finer = distanceOf(healed, options_.distance, seconds, kFineness);
    clock_.lap("tessellate");
    return finer;
  }

  Result<void> useFacets(const Body& body, const TrueDistance& phi, const Deadline& deadline) {
    Result<FacetAttempt> facets =
        facetBody(body, options_, phi, *check_, deadline, progress_.part(0.8, 1, "facets"));
    clock_.lap("facets");
    if (!facets) return tl::unexpected(facets.error());
    report().setting = "facets of the iso-surface";
    report().check = std::move(facets->file.check);
    report().checkedFile = facets->file.fingerprint;
    report().facetedFaces = facets->facets;
    report().exactFaces = facets->planarFaces;
    result_.bodies = std::move(facets->bodies);
    report().kind = kindOf(OffsetKind::Faceted);
    return {};
  }

  /// Faces cut one by one; where they do not pass, facets of the front.
  Result<void> useTrimmedFaces(const Body& healed, const TrueDistance& phi) {
    Result<SheetAttempt> sheet = sheetOfFaces(healed, options_, phi, *check_, deadline_,
                                              progress_.part(0.8, 0.9, "trimmed faces"));
    clock_.lap("trimmed faces");
    if (!sheet) return tl::unexpected(sheet.error());
    if (!sheet->check.pass()) {
      report().attempts.push_back("trimmed faces: rejected: " + sheet->check.reasons.front());
      const Deadline deadline(deadline_.left() + kExtraSeconds);
      const Result<TrueDistance> finer = finerDistance(healed, deadline);
      if (Result<void> found = useFacets(healed, finer ? *finer : phi, deadline); !found)
        return found;
      // Of two that fail the one that is exact but in places.
      if (report().check.pass() || sheet->bodies.empty() || !sheet->check.valid) return {};
      report().attempts.push_back("facets: rejected: " + report().check.reasons.front());
      report().facetedFaces = 0;
    }
    report().setting = "trimmed faces";
    report().checkedFile = 0;
    report().exactFaces = sheet->exactFaces;
    report().fittedFaces = sheet->fittedFaces;
    report().check = std::move(sheet->check);
    result_.bodies = std::move(sheet->bodies);
    report().kind = kindOf(OffsetKind::Exact);
    return {};
  }

  /// Of what there is, if its check passes.
  [[nodiscard]] OffsetKind kindOf(OffsetKind made) const {
    if (!result_.report.check.pass()) return OffsetKind::Failed;
    return result_.bodies.empty() ? OffsetKind::Empty : made;
  }

  static OffsetOptions withArcs(OffsetOptions options) {
    options.join = Join::Arc;
    return options;
  }

  const Body& body_;
  const OffsetOptions& wanted_;
  const OffsetOptions options_;  ///< with arcs: made first, and offered where no mitre passes
  const Progress& progress_;
  const Deadline deadline_;
  BodyOffset result_;
  StageClock clock_;
  std::optional<BodyCheck> check_;
  AttemptLog attempts_;
  bool mitreTried_ = false;
};

}  // namespace

Result<BodyOffset> offsetBody(const Body& body, const OffsetOptions& options,
                              const Progress& progress) {
  return BodyOffsetter(body, options, progress).run();
}

}  // namespace phront::cad
