#include "rebuild/body_offset.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <sstream>

#include "deadline.h"
#include "exchange/guard.h"
#include "exchange/shape_bytes.h"
#include "heal/heal.h"
#include "phront/cad/shape_occt.h"
#include "phront/cad/tessellate.h"
#include "phront/facet.h"
#include "phront/iso_surface.h"
#include "rebuild/attempt_runner.h"
#include "rebuild/facet_solid.h"
#include "rebuild/patch_tools.h"
#include "rebuild/true_distance.h"

namespace phront::cad {
namespace {

using Clock = std::chrono::steady_clock;

// Triangles follow the faces to this share of |d|: far below the 1 % that a result may deviate, and
// what is left disappears where feet are refined on the true surface.
constexpr double kDeflectionOfDistance = 0.002;
// ... but not finer than this share of the diagonal: tiny distances on large parts.
constexpr double kFinestDeflection = 4e-6;
// ... and not coarser: large distances still need the shape.
constexpr double kCoarsestDeflection = 3e-4;
// Deviation at which facets are chosen, as a share of the tolerance. The tolerance bounds a 99th
// percentile; this bounds the bulk.
constexpr double kFacetShareOfTolerance = 0.6;

// How far a recognised plane, cylinder, ... may lie from the freeform face it stands for: of the
// diagonal, and of |d|, so that it spends little of the tolerance.
constexpr double kRecognitionOfDiagonal = 2e-6;
constexpr double kRecognitionOfDistance = 1e-3;
constexpr double kRecognitionSeconds = 10;
constexpr double kRecognitionMemoryMiB = 2000;
// Shares of the time left: attempts where facets can follow, and where nothing can; facets.
constexpr double kAttemptShare = 0.6;
constexpr double kOnlyAttemptsShare = 0.9;
constexpr double kFacetShare = 0.6;
constexpr double kTessellateShare = 0.3;
constexpr double kFrontShare = 0.35;
// Bounds of the seconds for facets and for one measurement of the result.
constexpr double kLeastSeconds = 3;
constexpr double kFacetSeconds = 40;
constexpr double kCheckSeconds = 40;
constexpr double kFacetMemoryMiB = 4000;
// The front is refined for thin features up to this many nodes, some 8 s.
constexpr std::int64_t kMostFrontNodes = 2'500'000;

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

std::vector<std::optional<Plane>> planesOf(const FeatureTable& features) {
  std::vector<std::optional<Plane>> planes;
  for (const FaceFeature& face : features.faces) planes.push_back(face.plane);
  return planes;
}

CheckResult failedCheck(std::string reason) {
  CheckResult check;
  check.reasons.push_back(std::move(reason));
  return check;
}

Result<CheckResult> checkBody(const Body& body, const std::vector<Body>& result,
                              const OffsetOptions& options, const Deadline& deadline) {
  Model in;
  in.bodies.push_back(body);
  Model out;
  out.bodies = result;
  CheckOptions check;
  check.distance = options.distance;
  check.tolerance = options.tolerance;
  check.samples = kOfferedSamples;
  check.timeLimit = deadline.forStep(1, kLeastSeconds, kCheckSeconds);
  return checkOffset(in, out, check);
}

int curvedFacets(const FacetedSurface& facets, const FeatureTable& features) {
  int count = 0;
  for (const FacetPolygon& polygon : facets.polygons) {
    const bool planar = polygon.feature.kind == FeatureKind::Face &&
                        features.faces[static_cast<std::size_t>(polygon.feature.id)].plane;
    if (!planar) ++count;
  }
  return count;
}

// Facets and their solid as bytes: "<max deviation> <curved facets> <facets>\n" and the shape.
Result<std::string> makeFacetSolid(const OffsetOptions& options, const TrueDistance& phi,
                                   const IsoSurface& front) {
  FacetOptions facetOptions;
  facetOptions.tolerance = kFacetShareOfTolerance * *options.tolerance;
  facetOptions.planeOfFace = planesOf(phi.tessellation().features);
  facetOptions.threads = 1;  // a guarded child starts no thread
  const Result<FacetedSurface> facets =
      facetIsoSurface(phi.surface(), front, options.distance, facetOptions);
  if (!facets) return tl::unexpected(facets.error());
  const Result<TopoDS_Shape> solid = solidOfFacets(*facets);
  if (!solid) return tl::unexpected(solid.error());
  return fmt::format("{} {}\n", curvedFacets(*facets, phi.tessellation().features),
                     facets->polygons.size()) +
         bytesOfShape(*solid);
}

// The iso-surface itself becomes the solid.
void useFacets(const Body& body, const OffsetOptions& options, const TrueDistance& phi,
               const IsoSurface& front, const Deadline& deadline, BodyOffset& result) {
  BodyReport& report = result.report;
  report.setting = "facets of the iso-surface";
  const Result<std::string> bytes =
      runInChild("facets of the iso-surface",
                 {deadline.forStep(kFacetShare, kLeastSeconds, kFacetSeconds), kFacetMemoryMiB},
                 [&] { return makeFacetSolid(options, phi, front); });
  if (!bytes) {
    report.check = failedCheck(bytes.error().message);
    return;
  }
  const std::size_t headerEnd = bytes->find('\n');
  std::istringstream header(bytes->substr(0, headerEnd));
  int total = 0;
  header >> report.facetedFaces >> total;
  report.exactFaces = total - report.facetedFaces;
  const Result<TopoDS_Shape> solid = shapeOfBytes(std::string_view(*bytes).substr(headerEnd + 1));
  if (!solid) {
    report.check = failedCheck(solid.error().message);
    return;
  }
  result.bodies = bodiesOf(*solid, BodyKind::Solid, body.name);
  const Result<CheckResult> check = checkBody(body, result.bodies, options, deadline);
  report.check = check ? *check : failedCheck(check.error().message);
  report.kind = report.check.pass() ? OffsetKind::Faceted : OffsetKind::Failed;
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

  const bool solid = body.kind == BodyKind::Solid;
  std::optional<IsoSurface> front;
  std::optional<FrontReference> reference;
  if (solid && phi->surface().closed()) {
    IsoSurfaceOptions isoOptions;
    isoOptions.level = options.distance;
    isoOptions.mostRefinedNodes = kMostFrontNodes;
    isoOptions.threads = options.threads;
    const Progress part = progress.part(0.1, 0.3, "front");
    const Deadline frontDeadline(kFrontShare * deadline.left());
    bool stopped = false;  // by the user, not by the time
    const Progress timed([&](double fraction, std::string_view) {
      stopped = stopped || !part.report(fraction);
      return !stopped && frontDeadline.left() > 0;
    });
    Result<IsoSurface> iso = isoSurface(phi->surface(), isoOptions, timed);
    if (stopped) return fail(ErrorCode::Cancelled, "the offset was cancelled");
    if (iso) {
      front = std::move(*iso);
      reference = {signedVolume(front->mesh), area(front->mesh), front->spacing};
    } else {
      report.attempts.push_back(iso.error().code == ErrorCode::Cancelled
                                    ? "front: given up for want of time"
                                    : "front: " + iso.error().message);
    }
    clock.lap("front");
  }

  if (front && front->mesh.triangles.empty()) {
    const Result<CheckResult> check = checkBody(body, {}, options, deadline);
    clock.lap("check");
    if (check && check->pass()) {
      report.kind = OffsetKind::Empty;
      report.check = *check;
      return result;
    }
    // A rest thinner than the grid: the exact way may still find it.
    front.reset();
    reference.reset();
  }

  const Deadline attempts(deadline.left() * (front ? kAttemptShare : kOnlyAttemptsShare));
  AttemptLog log = runAttempts(body, healed, options, *phi, reference, attempts,
                               progress.part(0.3, 0.8, "exact patches"));
  clock.lap("exact patches");
  report.attempts.insert(report.attempts.end(), log.lines.begin(), log.lines.end());
  if (log.accepted) {
    result.bodies = std::move(log.accepted->bodies);
    report.kind = OffsetKind::Exact;
    report.setting = log.accepted->setting;
    report.check = log.accepted->check;
    report.fittedFaces = log.accepted->fittedFaces;
    report.exactFaces = report.check.faces - report.fittedFaces;
  } else if (front) {
    if (!progress.part(0.8, 1, "facets").report(0))
      return fail(ErrorCode::Cancelled, "the offset was cancelled");
    useFacets(body, options, *phi, *front, deadline, result);
    clock.lap("facets");
  } else {
    report.check = failedCheck(report.attempts.empty() ? "no way gave a result"
                                                       : "no attempt gave a result that passes: " +
                                                             report.attempts.back());
  }
  report.solids = report.check.solids;
  return result;
}

}  // namespace phront::cad
