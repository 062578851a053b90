#include "shell/thicken_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "deadline.h"
#include "exchange/face_set.h"
#include "exchange/guard.h"
#include "exchange/shape_bytes.h"
#include "heal/heal.h"
#include "judge/check_body.h"
#include "judge/check_thick.h"
#include "judge/read_back.h"
#include "patches/patch_tools.h"
#include "phront/cad/shape_occt.h"
#include "rebuild/attempt_runner.h"
#include "shell/close_sheet.h"
#include "shell/sheet_walls.h"
#include "shell/wall_steps.h"
#include "surfaces/face_offsets.h"
#include "tessellate/body_distance.h"

namespace phront::cad {
namespace {

using Clock = std::chrono::steady_clock;

// Shares of the time left.
constexpr double kTessellateShare = 0.2;
constexpr double kSideShare = 0.6;
constexpr double kClosingShare = 0.4;
constexpr double kLeastSeconds = 3;
constexpr double kMostClosingSeconds = 30;
constexpr double kMostCheckSeconds = 40;
constexpr double kWallSeconds = 20;
constexpr double kMemoryMiB = 3000;
constexpr double kOfDiagonal = 1e-6;  // polygons of the border, approximated walls
// Of the diagonal, and at most of the thickness: what free edges are sewn at.
constexpr double kSewing[] = {1e-6, 1e-5, 1e-4};
constexpr double kSewingOfThickness = 0.01;
constexpr double kFuzzies[] = {1e-7, 1e-6, 1e-5};
constexpr double kLevelOfDiagonal = 1e-5;

class SheetThickener {
 public:
  SheetThickener(const Body& sheet, const FreeBorder& border, const ShellBodyRequest& request,
                 const Progress& progress)
      : sheet_(sheet),
        request_(request),
        progress_(progress),
        deadline_(request.timeLimit),
        diagonal_(diagonalOf(occtShape(sheet.shape))),
        border_(border) {
    report().name = sheet.name;
    report().inputFaces = faceCount(sheet.shape);
    pieces_.walls = request.walls;
    pieces_.tolerance = kLevelOfDiagonal * diagonal_;
  }

  Result<BodyShell> run() {
    if (border_.badEdges() > 0)
      return fail(ErrorCode::NotSupported,
                  fmt::format("a sheet has {} edges where more than two faces meet, or where "
                              "faces disagree which of their sides is out: such a sheet has no "
                              "thickness; split or orient it in the CAD system it comes from",
                              border_.badEdges()));
    if (!progress_.report(0)) return fail(ErrorCode::Cancelled, "the shell was cancelled");
    const Result<TrueDistance> phi =
        distanceOf(sheet_, request_.walls.thickness(),
                   deadline_.forStep(kTessellateShare, kLeastSeconds, request_.timeLimit));
    if (!phi) return tl::unexpected(phi.error());
    for (const double height : {-request_.walls.inner, request_.walls.outer}) {
      const Result<bool> made = addSide(height);
      if (!made) return tl::unexpected(made.error());
      if (!*made) return std::move(made_);
    }
    if (addWalls()) close(*phi);
    return std::move(made_);
  }

 private:
  BodyReport& report() { return made_.report; }

  void lap(const std::string& stage, Clock::time_point start) {
    made_.times.push_back({stage, std::chrono::duration<double>(Clock::now() - start).count()});
  }

  void failBecause(const std::string& reason) {
    report().kind = OffsetKind::Failed;
    report().check = failedCheck(reason);
  }

  /// The sheet itself, or its offset; false when there is none.
  Result<bool> addSide(double height) {
    if (height == 0) {
      for (const TopoDS_Face& face : facesOf(occtShape(sheet_.shape)))
        pieces_.faces.push_back(face);
      return true;
    }
    const bool outer = height > 0;
    const std::string what = outer ? "the side along the normals" : "the side against the normals";
    const SideRequest side{height, deadline_.forStep(kSideShare, kLeastSeconds, request_.timeLimit),
                           what};
    const Result<std::optional<std::vector<Body>>> made = offsetSide(
        sheet_, side, request_, progress_.part(outer ? 0.4 : 0.05, outer ? 0.8 : 0.4, what), made_);
    if (!made) return tl::unexpected(made.error());
    if (!*made) return false;
    if ((*made)->empty()) failBecause(what + " is empty: the sheet is curved too much for it");
    for (const Body& body : **made)
      for (const TopoDS_Face& face : facesOf(occtShape(body.shape))) pieces_.faces.push_back(face);
    return !(*made)->empty();
  }

  bool addWalls() {
    const Clock::time_point start = Clock::now();
    const Result<std::string> bytes =
        runInChild("building walls", {kWallSeconds, kMemoryMiB}, [&]() -> Result<std::string> {
          const double tolerance = kOfDiagonal * diagonal_;
          const Result<std::vector<TopoDS_Face>> walls =
              sheetWalls(border_, request_.walls, tolerance);
          if (!walls) return tl::unexpected(walls.error());
          return bytesOfShape(makeElementary(compoundOf(*walls), tolerance).shape);
        });
    lap("walls", start);
    const Result<TopoDS_Shape> walls =
        bytes ? shapeOfBytes(*bytes) : Result<TopoDS_Shape>(tl::unexpected(bytes.error()));
    if (!walls) {
      failBecause(walls.error().message);
      return false;
    }
    for (const TopoDS_Face& face : facesOf(*walls)) pieces_.faces.push_back(face);
    return true;
  }

  [[nodiscard]] std::vector<ClosingWay> ways() const {
    std::vector<ClosingWay> ways;
    const double most = kSewingOfThickness * request_.walls.thickness();
    for (const double sewing : kSewing)
      ways.push_back({fmt::format("sewn at {:g} of the diagonal", sewing),
                      std::min(sewing * diagonal_, most), false, 0});
    for (const double fuzzy : kFuzzies)
      ways.push_back({fmt::format("cut, fuzzy {:g} of the diagonal", fuzzy),
                      std::min(kSewing[1] * diagonal_, most), true, fuzzy * diagonal_});
    return ways;
  }

  void close(const TrueDistance& phi) {
    const Clock::time_point start = Clock::now();
    if (!progress_.part(0.8, 1, "closing").report(0)) return failBecause("the shell was cancelled");
    for (const ClosingWay& way : ways()) {
      const GuardLimits limits{deadline_.forStep(kClosingShare, kLeastSeconds, kMostClosingSeconds),
                               kMemoryMiB};
      const Result<std::string> bytes =
          runInChild("closing the sheet", limits, [&]() -> Result<std::string> {
            const Result<TopoDS_Shape> solid = closeSheet(pieces_, phi, border_, way);
            if (!solid) return tl::unexpected(solid.error());
            return bytesOfShape(*solid);
          });
      if (tryResult(way.name, bytes ? shapeOfBytes(*bytes)
                                    : Result<TopoDS_Shape>(tl::unexpected(bytes.error()))))
        break;
    }
    lap("closing", start);
  }

  bool tryResult(const std::string& way, const Result<TopoDS_Shape>& solid) {
    if (!solid) {
      report().attempts.push_back(way + ": " + solid.error().message);
      if (report().check.reasons.empty()) report().check = failedCheck(solid.error().message);
      return false;
    }
    std::vector<Body> bodies = bodiesOf(*solid, BodyKind::Solid, sheet_.name);
    CheckResult check = judge(bodies);
    const bool passes = check.pass();
    report().attempts.push_back(way + ": " +
                                (passes ? "accepted" : "rejected: " + check.reasons.front()));
    if (!passes && !made_.bodies.empty()) return false;
    made_.bodies = std::move(bodies);
    report().check = std::move(check);
    report().kind = passes ? OffsetKind::Exact : OffsetKind::Failed;
    report().exactFaces = report().check.faces - report().fittedFaces;
    report().solids = report().check.solids;
    return passes;
  }

  [[nodiscard]] CheckResult judge(const std::vector<Body>& bodies) const {
    ShellCheckOptions options;
    options.walls = request_.walls;
    options.tolerance = request_.tolerance;
    options.samples = kOfferedSamples;
    options.timeLimit = deadline_.forStep(1, kLeastSeconds, kMostCheckSeconds);
    const Result<CheckResult> measured = checkThickSheet(sheet_, bodies, options);
    CheckResult check = measured ? *measured : failedCheck(measured.error().message);
    checkExchange(bodies, {diagonal_, request_.walls.thickness(), true}, check);
    return check;
  }

  const Body& sheet_;
  const ShellBodyRequest& request_;
  const Progress& progress_;
  const Deadline deadline_;
  const double diagonal_;
  const FreeBorder& border_;
  ThickSheetPieces pieces_;
  BodyShell made_;
};

}  // namespace

Result<BodyShell> thickenBody(const Body& sheet, const ShellBodyRequest& request,
                              const Progress& progress) {
  const Result<FreeBorder> border =
      guardOcct("finding the free edges of a sheet", [&]() -> Result<FreeBorder> {
        const TopoDS_Shape& shape = occtShape(sheet.shape);
        return FreeBorder(shape, kOfDiagonal * diagonalOf(shape));
      });
  if (!border) return tl::unexpected(border.error());
  return SheetThickener(sheet, *border, request, progress).run();
}

}  // namespace phront::cad
