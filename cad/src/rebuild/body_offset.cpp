#include "rebuild/body_offset.h"

#include <chrono>
#include <cmath>

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
#include "tessellate/true_distance.h"

namespace phront::cad {
namespace {

using Clock = std::chrono::steady_clock;

// Triangles follow the faces to this share of |d|: far below the 1 % that a result may deviate, and
// what is left disappears where feet are refined on the true surface.
constexpr double kDeflectionOfDistance = 0.004;
// ... but not finer than this share of the diagonal: tiny distances on large parts.
constexpr double kFinestDeflection = 4e-6;
// ... and not coarser: large distances still need the shape.
constexpr double kCoarsestDeflection = 3e-4;
// How far a recognised plane, cylinder, ... may lie from the freeform face it stands for: of the
// diagonal, and of |d|, so that it spends little of the tolerance.
constexpr double kRecognitionOfDiagonal = 2e-6;
constexpr double kRecognitionOfDistance = 1e-3;
constexpr double kRecognitionSeconds = 10;
constexpr double kRecognitionMemoryMiB = 2000;
// Shares of the time left: attempts where facets can follow, and where nothing can.
constexpr double kAttemptShare = 0.6;
constexpr double kOnlyAttemptsShare = 0.9;
constexpr double kTessellateShare = 0.3;
constexpr double kMostTessellateSeconds = 45;
// Of the front: first, when all else is still to come; and when only facets follow.
constexpr double kFirstFrontShare = 0.25;
constexpr double kLateFrontShare = 0.5;
// Bounds of the seconds for one measurement of the result.
constexpr double kLeastSeconds = 3;
constexpr double kCheckSeconds = 40;
// Nodes up to which the front is refined for thin features: for facets; and where it decides that
// nothing is left.
constexpr std::int64_t kFacetNodes = 150'000;
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

double deflectionFor(double distance, double diagonal) {
  return std::clamp(kDeflectionOfDistance * std::abs(distance), kFinestDeflection * diagonal,
                    kCoarsestDeflection * diagonal);
}

Result<TrueDistance> prepareDistance(const Body& body, double distance, double seconds) {
  TessellateOptions tessellation;
  tessellation.distance = std::abs(distance);
  tessellation.deflection = deflectionFor(distance, diagonalOf(occtShape(body.shape)));
  tessellation.smoothTolerance = tessellation.deflection;
  tessellation.timeLimit = seconds;
  Result<Tessellation> mesh = tessellate(body, tessellation);
  if (!mesh && mesh.error().code == ErrorCode::Failed) {
    return fail(ErrorCode::UnreadableInput, "the part cannot be measured: " + mesh.error().message +
                                                " Repair it in the CAD system it comes from.");
  }
  if (!mesh) return tl::unexpected(mesh.error());
  return TrueDistance::build(occtShape(body.shape), std::move(*mesh));
}

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

// The front, refined far only where it decides whether anything is left.
Result<IsoSurface> frontOf(const TrueDistance& phi, const OffsetOptions& options,
                           const Deadline& deadline, const Progress& progress) {
  const double share = options.distance < 0 ? kFirstFrontShare : kLateFrontShare;
  const double seconds = share * deadline.left();
  const Deadline end(seconds);
  Result<IsoSurface> front =
      makeFront(phi.surface(), options.distance, options.threads, {kFacetNodes, seconds}, progress);
  if (!front || !front->mesh.triangles.empty() || !front->unresolved) return front;
  return makeFront(phi.surface(), options.distance, options.threads, {kEmptyNodes, end.left()},
                   progress);
}

void useFacets(const Body& body, const OffsetOptions& options, const TrueDistance& phi,
               const IsoSurface* front, const Deadline& deadline, BodyOffset& result) {
  BodyReport& report = result.report;
  FacetAttempt facets = facetBody(body, options, phi, front, deadline);
  report.setting = "facets of the iso-surface";
  report.check = std::move(facets.check);
  report.facetedFaces = facets.facets;
  report.exactFaces = facets.planarFaces;
  report.kind = report.check.pass() ? OffsetKind::Faceted : OffsetKind::Failed;
  result.bodies = std::move(facets.bodies);
}

void useAttempt(JudgedAttempt attempt, OffsetKind kind, BodyOffset& result) {
  BodyReport& report = result.report;
  result.bodies = std::move(attempt.bodies);
  report.kind = kind;
  report.setting = attempt.setting;
  report.check = std::move(attempt.check);
  report.fittedFaces = attempt.fittedFaces;
  report.exactFaces = report.check.faces - report.fittedFaces;
}

}  // namespace

Result<BodyOffset> offsetBody(const Body& body, const OffsetOptions& options,
                              const Progress& progress) {
  BodyOffset result;
  BodyReport& report = result.report;
  const Deadline deadline(options.timeLimit);
  StageClock clock(result.times);
  report.name = body.name;
  report.inputFaces = faceCount(body.shape);

  if (!progress.part(0, 0.1, "tessellate").report(0))
    return fail(ErrorCode::Cancelled, "the offset was cancelled");
  const Body healed = withElementarySurfaces(body, options.distance, report.attempts);
  clock.lap("heal");
  Result<TrueDistance> phi = prepareDistance(healed, options.distance,
                                             deadline.forStep(kTessellateShare, kLeastSeconds, 45));
  if (!phi) return tl::unexpected(phi.error());
  clock.lap("tessellate");

  const bool faceted = body.kind == BodyKind::Solid && phi->surface().closed();
  std::optional<IsoSurface> front;
  const auto makeFrontNow = [&](const Progress& part) -> Result<void> {
    Result<IsoSurface> made = frontOf(*phi, options, deadline, part);
    clock.lap("front");
    if (!made && made.error().code == ErrorCode::Cancelled) return tl::unexpected(made.error());
    if (made)
      front = std::move(*made);
    else
      report.attempts.push_back(made.error().message);
    return {};
  };

  // Inwards nothing may be left, which the front knows soonest.
  if (faceted && options.distance < 0) {
    const Result<void> made = makeFrontNow(progress.part(0.1, 0.3, "front"));
    if (!made) return tl::unexpected(made.error());
  }
  const bool emptyFront = front && front->mesh.triangles.empty();
  if (emptyFront) {
    const CheckResult check =
        checkBody(body, {}, options, deadline.forStep(1, kLeastSeconds, kCheckSeconds));
    clock.lap("check");
    if (check.pass()) {
      report.kind = OffsetKind::Empty;
      report.check = check;
      return result;
    }
    // A rest thinner than the grid: the exact way may still find it.
    front.reset();
  }

  const bool facetsMayFollow = faceted && !emptyFront;
  const Deadline attempts(deadline.left() * (facetsMayFollow ? kAttemptShare : kOnlyAttemptsShare));
  AttemptLog log =
      runAttempts(body, healed, options, *phi, attempts, progress.part(0.3, 0.8, "exact patches"));
  clock.lap("exact patches");
  report.attempts.insert(report.attempts.end(), log.lines.begin(), log.lines.end());
  if (log.accepted) {
    useAttempt(std::move(*log.accepted), OffsetKind::Exact, result);
    report.solids = report.check.solids;
    return result;
  }

  if (facetsMayFollow && options.distance > 0) {
    const Result<void> made = makeFrontNow(progress.part(0.8, 0.9, "front"));
    if (!made) return tl::unexpected(made.error());
  }
  if (facetsMayFollow) {
    if (!progress.part(0.9, 1, "facets").report(0))
      return fail(ErrorCode::Cancelled, "the offset was cancelled");
    useFacets(body, options, *phi, front ? &*front : nullptr, deadline, result);
    clock.lap("facets");
  } else {
    report.check = failedCheck(report.attempts.empty() ? "no way gave a result"
                                                       : "no attempt gave a result that passes: " +
                                                             report.attempts.back());
  }
  // Better a result that fails its check, marked as such, than none.
  if (result.bodies.empty() && log.rejected)
    useAttempt(std::move(*log.rejected), OffsetKind::Failed, result);
  report.solids = report.check.solids;
  return result;
}

}  // namespace phront::cad
