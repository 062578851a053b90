#include "rebuild/front_stage.h"

#include <string_view>

#include "deadline.h"

namespace phront::cad {
namespace {

// Some seconds' worth; facets are refined by deviation later on.
constexpr double kMostSquares = 40'000;

}  // namespace

Result<IsoSurface> makeFront(const SurfaceDistance& surface, double level, int threads,
                             const FrontBounds& bounds, const Progress& progress) {
  IsoSurfaceOptions options;
  options.level = level;
  options.mostRefinedNodes = bounds.nodes;
  options.creaseTolerance = bounds.creaseTolerance;
  options.mostSquares = kMostSquares;
  options.threads = threads;
  const Deadline deadline(bounds.seconds);
  bool stopped = false;  // by the user, not by the time
  const Progress timed([&](double fraction, std::string_view) {
    stopped = stopped || !progress.report(fraction);
    return !stopped && deadline.left() > 0;
  });
  Result<IsoSurface> front = isoSurface(surface, options, timed);
  if (stopped) return fail(ErrorCode::Cancelled, "the offset was cancelled");
  if (!front && front.error().code == ErrorCode::Cancelled)
    return fail(ErrorCode::ResourceLimit, "front: given up for want of time");
  return front;
}

}  // namespace phront::cad
