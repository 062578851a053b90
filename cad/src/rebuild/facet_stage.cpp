#include "rebuild/facet_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "exchange/guard.h"
#include "exchange/shape_bytes.h"
#include "phront/facet.h"
#include "rebuild/attempt_runner.h"
#include "rebuild/facet_bias.h"
#include "rebuild/facet_solid.h"
#include "rebuild/front_stage.h"
#include "rebuild/plane_features.h"

namespace phront::cad {
namespace {

// Deviation at which facets are chosen, as a share of the tolerance. The tolerance bounds a 99th
// percentile; this bounds the bulk.
constexpr double kShareOfTolerance = 0.85;
constexpr Index kMostFacets = 60'000;
constexpr double kMemoryMiB = 4000;
// The level: where fronts just meet at d they leave a gap here, and the grid sees it. It spends
// less than a tenth of the tolerance.
constexpr double kReach = 0.9992;
// The front: nodes, the deviation at creases in |d|, and its share of the time left.
constexpr std::int64_t kFrontNodes = 2'000'000;
constexpr double kCreaseTolerance = 0.03;
constexpr double kFrontShare = 0.45;
constexpr double kSheetFrontShare = 0.3;  // twice the surface, and no need to close
// Seconds for making facets and for one measurement: share of the time left, least and most.
constexpr double kTimeShare = 0.6;
constexpr double kLeastSeconds = 10;
constexpr double kMostSeconds = 40;
// To read back and to check one of many facets: 0.5 and 0.4 ms were seen.
constexpr double kSecondsPerFacet = 1e-3;
// Coarse facets: some seconds whatever the part. The grid is no wider than the front is off the
// part, else facets would cut through it.
constexpr double kCoarseSpacing = 1.0 / 60;  // of the diagonal
constexpr double kCoarseSpacingOfDistance = 1.5;
constexpr double kCoarseSquares = 25'000;  // over the part's area, whatever the spacing wanted
constexpr double kCoarseTolerance = 0.1;   // of |d|
constexpr Index kCoarseFacets = 8000;

class FacetStage {
 public:
  FacetStage(const Body& body, const OffsetOptions& options, const TrueDistance& phi,
             const BodyCheck& check, const Deadline& deadline)
      : body_(body), options_(options), phi_(phi), check_(check), deadline_(deadline) {
    if (isSheet()) {
      Result<SurfaceDistance> around =
          SurfaceDistance::build(phi.surface().mesh(), SignRule::Unsigned);
      if (around) aroundSheet_ = std::move(*around);
    }
    facetOptions_.planeOfFace = planesOf(phi.tessellation().features);
    facetOptions_.threads = 1;  // a guarded child starts no thread
  }

  Result<FacetAttempt> fine(const Progress& progress) {
    const double level = kReach * options_.distance;
    FrontBounds bounds;
    bounds.nodes = kFrontNodes;
    bounds.seconds = (isSheet() ? kSheetFrontShare : kFrontShare) * deadline_.left();
    bounds.creaseTolerance = kCreaseTolerance * std::abs(level);
    const Result<IsoSurface> front =
        makeFront(around(), levelOfFront(level), options_.threads, bounds, progress);
    if (!front && front.error().code == ErrorCode::Cancelled) {
      return tl::unexpected(front.error());
    }
    if (!front) return nothing(front.error().message);
    facetOptions_.tolerance = kShareOfTolerance * *options_.tolerance;
    facetOptions_.maxFacets = kMostFacets;
    return attempt(*front, level);
  }

  FacetAttempt coarse() {
    IsoSurfaceOptions coarse;
    coarse.level = levelOfFront(options_.distance);
    coarse.spacing = std::min(kCoarseSpacing * phi_.surface().box().diagonal().norm(),
                              kCoarseSpacingOfDistance * std::abs(options_.distance));
    coarse.spacing =
        std::max(*coarse.spacing, std::sqrt(area(phi_.surface().mesh()) / kCoarseSquares));
    coarse.mostRefinedNodes = 0;
    coarse.threads = options_.threads;
    const Result<IsoSurface> front = isoSurface(around(), coarse);
    if (!front) return nothing(front.error().message);
    facetOptions_.tolerance = kCoarseTolerance * std::abs(options_.distance);
    facetOptions_.maxFacets = kCoarseFacets;
    return attempt(*front, options_.distance);
  }

 private:
  [[nodiscard]] bool isSheet() const { return body_.kind == BodyKind::Sheet; }
  /// What the front is of: around a sheet it is closed, too.
  [[nodiscard]] const SurfaceDistance& around() const {
    return aroundSheet_ ? *aroundSheet_ : phi_.surface();
  }
  [[nodiscard]] double levelOfFront(double level) const {
    return isSheet() ? std::abs(level) : level;
  }

  static FacetAttempt nothing(std::string why) {
    FacetAttempt none;
    none.file.check = failedCheck(std::move(why));
    return none;
  }

  /// As bytes: "<curved facets> <facets>\n" and the shape, where there are any.
  [[nodiscard]] Result<std::string> facetShape(const IsoSurface& front, double level) const {
    Result<FacetedSurface> facets =
        isSheet() ? facetSheet(phi_.surface(), around(), front, level, facetOptions_)
                  : facetIsoSurface(phi_.surface(), front, level, facetOptions_);
    if (!facets) return tl::unexpected(facets.error());
    if (facets->polygons.empty()) return std::string("0 0\n");
    removeChordalBias(*facets, 0, level, phi_);
    const Result<TopoDS_Shape> shape = isSheet() ? sheetOfFacets(*facets) : solidOfFacets(*facets);
    if (!shape) return tl::unexpected(shape.error());
    return fmt::format("{} {}\n", curvedFacets(*facets, facetOptions_.planeOfFace),
                       facets->polygons.size()) +
           bytesOfShape(*shape);
  }

  FacetAttempt attempt(const IsoSurface& front, double level) const {
    FacetAttempt made;
    const Result<std::string> bytes =
        runInChild("facets of the iso-surface",
                   {deadline_.forStep(kTimeShare, kLeastSeconds, kMostSeconds), kMemoryMiB},
                   [&] { return facetShape(front, level); });
    if (!bytes) return nothing(bytes.error().message);
    const std::size_t headerEnd = bytes->find('\n');
    std::istringstream header(bytes->substr(0, headerEnd));
    int total = 0;
    header >> made.facets >> total;
    made.planarFaces = total - made.facets;
    if (total == 0) {
      made.file.check =
          check_.inMemory({}, options_, deadline_.forStep(1, kLeastSeconds, kMostSeconds));
      return made;
    }
    if (kSecondsPerFacet * total > std::max(deadline_.left(), kLeastSeconds)) {
      return nothing(fmt::format("there is no time to check {} facets", total));
    }
    const Result<TopoDS_Shape> shape = shapeOfBytes(std::string_view(*bytes).substr(headerEnd + 1));
    if (!shape) return nothing(shape.error().message);
    made.bodies = bodiesOf(*shape, body_.kind, body_.name);
    made.file =
        check_.fromFile(made.bodies, options_, deadline_.forStep(1, kLeastSeconds, kMostSeconds));
    return made;
  }

  const Body& body_;
  const OffsetOptions& options_;
  const TrueDistance& phi_;
  const BodyCheck& check_;
  const Deadline& deadline_;
  std::optional<SurfaceDistance> aroundSheet_;
  FacetOptions facetOptions_;
};

}  // namespace

Result<FacetAttempt> facetBody(const Body& body, const OffsetOptions& options,
                               const TrueDistance& phi, const BodyCheck& check,
                               const Deadline& deadline, const Progress& progress) {
  Result<FacetAttempt> fine = FacetStage(body, options, phi, check, deadline).fine(progress);
  if (!fine || !fine->bodies.empty() || fine->file.check.pass()) return fine;
  FacetAttempt coarse = coarseFacets(body, options, phi, check, deadline);
  if (coarse.bodies.empty()) return fine;
  std::vector<std::string>& reasons = coarse.file.check.reasons;
  reasons.insert(reasons.begin(), fine->file.check.reasons.begin(), fine->file.check.reasons.end());
  return coarse;
}

FacetAttempt coarseFacets(const Body& body, const OffsetOptions& options, const TrueDistance& phi,
                          const BodyCheck& check, const Deadline& deadline) {
  return FacetStage(body, options, phi, check, deadline).coarse();
}

}  // namespace phront::cad
