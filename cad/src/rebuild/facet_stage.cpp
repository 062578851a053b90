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

namespace phront::cad {
namespace {

// Deviation at which facets are chosen, as a share of the tolerance. The tolerance bounds a 99th
// percentile; this bounds the bulk.
constexpr double kShareOfTolerance = 0.8;
constexpr double kMemoryMiB = 4000;
// Seconds for making facets and for one measurement: share of the time left, least and most.
constexpr double kTimeShare = 0.6;
constexpr double kLeastSeconds = 5;
constexpr double kMostSeconds = 40;
// A finer front is worth it with so much time left.
constexpr double kWorthSeconds = 15;
constexpr std::int64_t kFinerNodes = 600'000;
// Coarse facets: some seconds whatever the part. The grid is no wider than the front is off the
// part, else facets would cut through it.
constexpr double kCoarseSpacing = 1.0 / 60;  // of the diagonal
constexpr double kCoarseSpacingOfDistance = 1.5;
constexpr double kCoarseSquares = 25'000;  // over the part's area, whatever the spacing wanted
constexpr double kCoarseTolerance = 0.1;   // of |d|
constexpr Index kCoarseFacets = 8000;

std::vector<std::optional<Plane>> planesOf(const FeatureTable& features) {
  std::vector<std::optional<Plane>> planes;
  for (const FaceFeature& face : features.faces) planes.push_back(face.plane);
  return planes;
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

// Facets and their solid as bytes: "<curved facets> <facets>\n" and the shape.
Result<std::string> makeFacetSolid(double distance, const FacetOptions& options,
                                   const TrueDistance& phi, const IsoSurface& front) {
  Result<FacetedSurface> facets = facetIsoSurface(phi.surface(), front, distance, options);
  if (!facets) return tl::unexpected(facets.error());
  removeChordalBias(*facets, distance, phi);
  const Result<TopoDS_Shape> solid = solidOfFacets(*facets);
  if (!solid) return tl::unexpected(solid.error());
  return fmt::format("{} {}\n", curvedFacets(*facets, phi.tessellation().features),
                     facets->polygons.size()) +
         bytesOfShape(*solid);
}

class FacetStage {
 public:
  FacetStage(const Body& body, const OffsetOptions& options, const TrueDistance& phi,
             const BodyCheck& check, const Deadline& deadline)
      : body_(body), options_(options), phi_(phi), check_(check), deadline_(deadline) {
    facetOptions_.tolerance = kShareOfTolerance * *options.tolerance;
    facetOptions_.planeOfFace = planesOf(phi.tessellation().features);
    facetOptions_.threads = 1;  // a guarded child starts no thread
  }

  FacetAttempt run(const IsoSurface* front) {
    FacetAttempt best = nothing("there is no front to make facets of");
    if (front != nullptr) best = attempt(*front);
    if (front != nullptr && !best.check.pass() && front->unresolved &&
        deadline_.left() > kWorthSeconds) {
      const Result<IsoSurface> finer =
          makeFront(phi_.surface(), options_.distance, options_.threads,
                    {kFinerNodes, 0.5 * deadline_.left()}, {});
      if (finer) {
        FacetAttempt again = attempt(*finer);
        if (again.check.pass() || best.bodies.empty()) best = std::move(again);
      }
    }
    if (best.bodies.empty()) {
      FacetAttempt coarse = attemptCoarse();
      if (!coarse.bodies.empty()) {
        coarse.check.reasons.insert(coarse.check.reasons.begin(), best.check.reasons.begin(),
                                    best.check.reasons.end());
        return coarse;
      }
    }
    return best;
  }

 private:
  static FacetAttempt nothing(std::string why) {
    FacetAttempt none;
    none.check = failedCheck(std::move(why));
    return none;
  }

  FacetAttempt attempt(const IsoSurface& front) const {
    FacetAttempt made;
    const Result<std::string> bytes =
        runInChild("facets of the iso-surface",
                   {deadline_.forStep(kTimeShare, kLeastSeconds, kMostSeconds), kMemoryMiB},
                   [&] { return makeFacetSolid(options_.distance, facetOptions_, phi_, front); });
    if (!bytes) return nothing(bytes.error().message);
    const std::size_t headerEnd = bytes->find('\n');
    std::istringstream header(bytes->substr(0, headerEnd));
    int total = 0;
    header >> made.facets >> total;
    made.planarFaces = total - made.facets;
    const Result<TopoDS_Shape> solid = shapeOfBytes(std::string_view(*bytes).substr(headerEnd + 1));
    if (!solid) return nothing(solid.error().message);
    made.bodies = bodiesOf(*solid, BodyKind::Solid, body_.name);
    made.check =
        check_.inMemory(made.bodies, options_, deadline_.forStep(1, kLeastSeconds, kMostSeconds));
    return made;
  }

  FacetAttempt attemptCoarse() {
    IsoSurfaceOptions coarse;
    coarse.level = options_.distance;
    coarse.spacing = std::min(kCoarseSpacing * phi_.surface().box().diagonal().norm(),
                              kCoarseSpacingOfDistance * std::abs(options_.distance));
    coarse.spacing =
        std::max(*coarse.spacing, std::sqrt(area(phi_.surface().mesh()) / kCoarseSquares));
    coarse.mostRefinedNodes = 0;
    coarse.threads = options_.threads;
    const Result<IsoSurface> front = isoSurface(phi_.surface(), coarse);
    if (!front) return nothing(front.error().message);
    facetOptions_.tolerance = kCoarseTolerance * std::abs(options_.distance);
    facetOptions_.maxFacets = kCoarseFacets;
    return attempt(*front);
  }

  const Body& body_;
  const OffsetOptions& options_;
  const TrueDistance& phi_;
  const BodyCheck& check_;
  const Deadline& deadline_;
  FacetOptions facetOptions_;
};

}  // namespace

FacetAttempt facetBody(const Body& body, const OffsetOptions& options, const TrueDistance& phi,
                       const BodyCheck& check, const IsoSurface* front, const Deadline& deadline) {
  return FacetStage(body, options, phi, check, deadline).run(front);
}

}  // namespace phront::cad
