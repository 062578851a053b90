#include "shell/shell_body.h"

#include <fmt/format.h>

#include <BRep_Builder.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Iterator.hxx>
#include <algorithm>
#include <chrono>
#include <utility>

#include "deadline.h"
#include "exchange/guard.h"
#include "exchange/shape_bytes.h"
#include "judge/check_body.h"
#include "judge/read_back.h"
#include "patches/patch_tools.h"
#include "phront/cad/shape_occt.h"
#include "rebuild/attempt_runner.h"
#include "shell/cut.h"
#include "shell/hollow.h"
#include "shell/opening.h"
#include "shell/wall_steps.h"

namespace phront::cad {
namespace {

using Clock = std::chrono::steady_clock;

// Of the wall: prisms over the openings are so high, so that their own tops hold nothing back.
constexpr double kHeight = 1.5;
// Of the outer wall: what lies so near to a prism, beyond its opening, is cut off.
constexpr double kBeyond = 1.5;
constexpr double kExtendSeconds = 20;
constexpr double kExtendMemoryMiB = 2000;
// Shares of the time left.
constexpr double kOffsetShare = 0.7;
constexpr double kBeyondShare = 0.2;
constexpr double kCutShare = 0.3;
constexpr double kLeastSeconds = 3;
constexpr double kMostCutSeconds = 30;
constexpr double kCutMemoryMiB = 3000;
constexpr double kMostCheckSeconds = 40;
// Of the diagonal, tried one after the other.
constexpr double kFuzzies[] = {0, 1e-6, 1e-5};

Body solidOf(const TopoDS_Shape& shape, const std::string& name) {
  Body body;
  body.shape = makeShape(shape);
  body.kind = BodyKind::Solid;
  body.name = name;
  return body;
}

/// What came across the process border: the extended solid, then each opening's two solids.
struct Extended {
  TopoDS_Shape solid;
  std::vector<std::pair<TopoDS_Shape, TopoDS_Shape>> beyond;  ///< continuation, below
};

Result<Extended> extend(const TopoDS_Shape& solid, const std::vector<int>& open,
                        const ShellBodyRequest& request) {
  if (open.empty()) return Extended{solid, {}};
  const double height = kHeight * std::max(request.walls.inner, request.walls.outer);
  const Result<std::string> bytes =
      runInChild("extending the part through its openings", {kExtendSeconds, kExtendMemoryMiB},
                 [&]() -> Result<std::string> {
                   const Result<ThroughOpenings> made = extendThrough(
                       solid, open, height, request.walls.outer > 0, request.firstNumber);
                   if (!made) return tl::unexpected(made.error());
                   BRep_Builder builder;
                   TopoDS_Compound all;
                   builder.MakeCompound(all);
                   builder.Add(all, made->solid);
                   for (const Opening& opening : made->openings) {
                     builder.Add(all, opening.continuation);
                     builder.Add(all, opening.below);
                   }
                   return bytesOfShape(all);
                 });
  if (!bytes) return tl::unexpected(bytes.error());
  const Result<TopoDS_Shape> all = shapeOfBytes(*bytes);
  if (!all) return tl::unexpected(all.error());
  Extended extended;
  TopoDS_Iterator part(*all);
  extended.solid = part.Value();
  for (part.Next(); part.More(); part.Next()) {
    const TopoDS_Shape continuation = part.Value();
    part.Next();
    extended.beyond.emplace_back(continuation, part.Value());
  }
  return extended;
}

std::vector<int> planarOf(const TopoDS_Shape& solid, const std::vector<int>& open) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(solid, TopAbs_FACE, faces);
  const double diagonal = diagonalOf(solid);
  std::vector<int> planar;
  for (const int f : open)
    if (isPlanar(TopoDS::Face(faces(f + 1)), diagonal)) planar.push_back(f);
  return planar;
}

class BodySheller {
 public:
  BodySheller(const Body& body, const ShellBodyRequest& request, const Progress& progress)
      : body_(body), request_(request), progress_(progress), deadline_(request.timeLimit) {
    made_.report.name = body.name;
    made_.report.inputFaces = faceCount(body.shape);
  }

  Result<BodyShell> run() {
    if (!progress_.part(0, 0.05, "openings").report(0))
      return fail(ErrorCode::Cancelled, "the shell was cancelled");
    const Clock::time_point start = Clock::now();
    const std::vector<int> planar = planarOf(occtShape(body_.shape), request_.open);
    allPlanar_ = planar.size() == request_.open.size();
    const Result<Extended> extended = extend(occtShape(body_.shape), planar, request_);
    if (!extended) return tl::unexpected(extended.error());
    const Result<Extended> forInner = extendedBase(request_.bases.inner, *extended);
    if (!forInner) return tl::unexpected(forInner.error());
    const Result<Extended> forOuter = extendedBase(request_.bases.outer, *extended);
    if (!forOuter) return tl::unexpected(forOuter.error());
    lap("openings", start);
    TopoDS_Shape from = occtShape(body_.shape);
    std::vector<TopoDS_Shape> tools;
    if (request_.walls.outer > 0) {
      const Result<bool> found = outerSide(*forOuter, from, tools);
      if (!found) return tl::unexpected(found.error());
      if (!*found) return std::move(made_);
    }
    if (request_.walls.inner > 0) {
      const Result<std::vector<Body>> cavity =
          offset(forInner->solid, -request_.walls.inner, kOffsetShare, "the cavity", 0.4, 0.8);
      if (!cavity) return tl::unexpected(cavity.error());
      if (failed_) return std::move(made_);
      for (const Body& solid : *cavity) tools.push_back(occtShape(solid.shape));
    } else {
      tools.push_back(extended->solid);
    }
    if (tools.empty() && request_.walls.outer == 0) return full();
    if (tools.empty())
      accepts("grown, nothing to cut", from);
    else
      cut(*extended, from, tools);
    return std::move(made_);
  }

 private:
  BodyReport& report() { return made_.report; }

  [[nodiscard]] Result<Extended> extendedBase(const std::optional<WallBase>& base,
                                              const Extended& otherwise) const {
    if (!base) return otherwise;
    const TopoDS_Shape solid = occtShape(base->body.shape);
    return extend(solid, planarOf(solid, base->open), request_);
  }

  void lap(const std::string& stage, Clock::time_point start) {
    made_.times.push_back({stage, std::chrono::duration<double>(Clock::now() - start).count()});
  }

  void failBecause(const std::string& reason) {
    failed_ = true;
    report().kind = OffsetKind::Failed;
    report().check = failedCheck(reason);
  }

  /// The offset of a solid; `failed_` when there is none that passes.
  Result<std::vector<Body>> offset(const TopoDS_Shape& solid, double distance, double share,
                                   const std::string& what, double from, double to) {
    const SideRequest side{distance, deadline_.forStep(share, kLeastSeconds, request_.timeLimit),
                           what};
    Result<std::optional<std::vector<Body>>> made = offsetSide(
        solidOf(solid, body_.name), side, request_, progress_.part(from, to, what), made_);
    if (!made) return tl::unexpected(made.error());
    failed_ = !*made;
    return failed_ ? std::vector<Body>() : std::move(**made);
  }

  /// The grown solid, and what of it lies beyond the openings. False when that failed.
  Result<bool> outerSide(const Extended& extended, TopoDS_Shape& from,
                         std::vector<TopoDS_Shape>& tools) {
    const double wall = request_.walls.outer;
    const Result<std::vector<Body>> grown =
        offset(extended.solid, wall, kOffsetShare, "the outer side", 0.05, 0.4);
    if (!grown) return tl::unexpected(grown.error());
    if (failed_) return false;
    if (grown->size() != 1) {
      failBecause("the outer side is not one solid");
      return false;
    }
    from = occtShape(grown->front().shape);
    for (const auto& [continuation, below] : extended.beyond) {
      const Result<std::vector<Body>> around = offset(continuation, kBeyond * wall, kBeyondShare,
                                                      "what lies beyond an opening", 0.4, 0.4);
      if (!around) return tl::unexpected(around.error());
      if (failed_) return false;
      for (const Body& solid : *around) {
        const Result<TopoDS_Shape> beyond =
            cutSolid(occtShape(solid.shape), {below}, 0,
                     deadline_.forStep(kCutShare, kLeastSeconds, kMostCutSeconds));
        if (!beyond) {
          failBecause(beyond.error().message);
          return false;
        }
        if (!beyond->IsNull()) tools.push_back(*beyond);
      }
    }
    return true;
  }

  Result<BodyShell> full() {
    made_.full = true;
    made_.bodies = {body_};
    report().kind = OffsetKind::Exact;
    judge(made_.bodies);
    report().exactFaces = report().check.faces;
    report().solids = report().check.solids;
    return std::move(made_);
  }

  void cut(const Extended& extended, const TopoDS_Shape& from,
           const std::vector<TopoDS_Shape>& tools) {
    if (!progress_.part(0.8, 1, "cutting").report(0)) return failBecause("the shell was cancelled");
    const Clock::time_point start = Clock::now();
    const double diagonal = diagonalOf(from);
    bool accepted = false;
    // Where only the cavity is cut out, it meets nothing but the openings, all planar.
    for (const double fuzzy : kFuzzies) {
      if (accepted || request_.walls.outer > 0 || !allPlanar_) break;
      accepted = accepts(fmt::format("hollowed, fuzzy {:g}", fuzzy),
                         hollow(extended, tools, fuzzy * diagonal));
    }
    for (const double fuzzy : kFuzzies) {
      if (accepted) break;
      accepted = accepts(fmt::format("cut, fuzzy {:g}", fuzzy),
                         cutSolid(from, tools, fuzzy * diagonal,
                                  deadline_.forStep(kCutShare, kLeastSeconds, kMostCutSeconds)));
    }
    lap("cut", start);
  }

  Result<TopoDS_Shape> hollow(const Extended& extended, const std::vector<TopoDS_Shape>& cavities,
                              double fuzzy) {
    HollowRequest request{occtShape(body_.shape), request_.open, {}, cavities, fuzzy};
    for (const auto& [continuation, below] : extended.beyond)
      request.continuations.push_back(continuation);
    const GuardLimits limits{deadline_.forStep(kCutShare, kLeastSeconds, kMostCutSeconds),
                             kCutMemoryMiB};
    const Result<std::string> bytes =
        runInChild("hollowing the part", limits, [&]() -> Result<std::string> {
          const Result<TopoDS_Shape> wall = hollowOut(request);
          if (!wall) return tl::unexpected(wall.error());
          return bytesOfShape(*wall);
        });
    if (!bytes) return tl::unexpected(bytes.error());
    return shapeOfBytes(*bytes);
  }

  /// Tells what became of one way to the wall.
  bool accepts(const std::string& way, const Result<TopoDS_Shape>& wall) {
    std::string outcome = "accepted";
    if (!wall)
      outcome = wall.error().message;
    else if (wall->IsNull())
      outcome = "nothing is left";
    else if (!tryWall(*wall))
      outcome = "rejected: " + report().check.reasons.front();
    report().attempts.push_back(way + ": " + outcome);
    if (outcome == "accepted") return true;
    if (report().check.reasons.empty()) report().check = failedCheck(outcome);
    return false;
  }

  /// Keeps the wall if it is the first, or passes.
  bool tryWall(const TopoDS_Shape& wall) {
    std::vector<Body> bodies = bodiesOf(wall, BodyKind::Solid, body_.name);
    judge(bodies);
    CheckResult& check = report().check;
    checkExchange(bodies, {diagonalOf(wall), request_.walls.thickness(), true}, check);
    if (made_.bodies.empty() || check.pass()) made_.bodies = std::move(bodies);
    if (!check.pass()) return false;
    report().kind = report().facetedFaces > 0 ? OffsetKind::Faceted : OffsetKind::Exact;
    // Facets of the cavity may lie beyond an opening.
    report().exactFaces = std::max(0, check.faces - report().fittedFaces - report().facetedFaces);
    report().solids = check.solids;
    return true;
  }

  void judge(const std::vector<Body>& bodies) {
    ShellCheckOptions options;
    options.walls = request_.walls;
    options.bases = request_.bases;
    options.tolerance = request_.tolerance;
    options.samples = kOfferedSamples;
    options.timeLimit = deadline_.forStep(1, kLeastSeconds, kMostCheckSeconds);
    const Result<CheckResult> check = checkBodyShell(body_, request_.open, bodies, options);
    report().check = check ? *check : failedCheck(check.error().message);
  }

  const Body& body_;
  const ShellBodyRequest& request_;
  const Progress& progress_;
  const Deadline deadline_;
  BodyShell made_;
  bool failed_ = false;
  bool allPlanar_ = true;  ///< openings
};

}  // namespace

Result<BodyShell> shellBody(const Body& body, const ShellBodyRequest& request,
                            const Progress& progress) {
  return BodySheller(body, request, progress).run();
}

}  // namespace phront::cad
