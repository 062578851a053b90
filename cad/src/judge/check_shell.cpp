// A point of the result is right when it lies on a closed face, on a wall's other side (at the
// wall's distance from the closed faces, to be sampled against the exact faces), or in the plane of
// an opening where a wall ends. What must be there is built from the closed faces alone: their
// points moved by the wall, kept where no other closed face is nearer and the solid has not ended.
#include "judge/check_shell.h"

#include <BRepAdaptor_Surface.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>
#include <set>

#include "exchange/face_set.h"
#include "judge/check_sampling.h"
#include "judge/wall_verdict.h"
#include "patches/patch_tools.h"
#include "phront/cad/shape_occt.h"
#include "tessellate/face_surface.h"

namespace phront::cad {
namespace {

constexpr double kLooseKeep = 1.2e-3;  // of the wall: nearer to another face than this is cut off
constexpr double kNearOpening = 1.5;   // walls from an opening: what lies above it is beyond
constexpr int kPerFace = 20;
constexpr std::uint64_t kAccuracySeed = 0x2545f4914f6cdd1d;
constexpr std::uint64_t kCoverageSeed = 0xda942042e4dd58b5;

struct Opening {
  bool planar = true;
  Vec3 point;
  Vec3 normal;  ///< out of the material
  ModelDistance face;
  [[nodiscard]] double height(const Vec3& x) const { return (x - point).dot(normal); }
  /// How far x is from where walls end. In the plane this is also right beside the face.
  [[nodiscard]] double off(const Vec3& x) const {
    return planar ? std::abs(height(x)) : face.distance(x);
  }
};

/// A body and its closed faces.
struct Solid {
  ModelDistance all;
  ModelDistance closed;
};

/// The body taken apart, and what its walls' far sides are measured from.
struct Parts {
  Solid in;
  std::optional<Solid> innerBase;
  std::optional<Solid> outerBase;
  std::deque<Opening> openings;  ///< a deque never moves what it holds
  [[nodiscard]] const Solid& inner() const { return innerBase ? *innerBase : in; }
  [[nodiscard]] const Solid& outer() const { return outerBase ? *outerBase : in; }
};

Body sheetOf(const FaceSet& faces) {
  Body sheet;
  sheet.shape = makeShape(shellOf(faces));
  sheet.kind = BodyKind::Sheet;
  return sheet;
}

Result<Solid> solidOf(const Body& body, const std::vector<int>& open, const TessellateOptions& mesh,
                      const std::string& what) {
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(occtShape(body.shape), TopAbs_FACE, map);
  const std::set<int> opened(open.begin(), open.end());
  FaceSet closed;
  for (int f = 0; f < map.Extent(); ++f)
    if (opened.count(f) == 0) closed.push_back(TopoDS::Face(map(f + 1)));
  if (closed.empty()) return fail(ErrorCode::InvalidArgument, "no face is left to be a wall");
  auto all = ModelDistance::build({body}, mesh, what);
  if (!all) return tl::unexpected(all.error());
  auto walls = ModelDistance::build({sheetOf(closed)}, mesh, "the walls of " + what);
  if (!walls) return tl::unexpected(walls.error());
  return Solid{std::move(*all), std::move(*walls)};
}

Result<std::optional<Solid>> baseOf(const std::optional<WallBase>& base,
                                    const TessellateOptions& mesh) {
  if (!base) return std::optional<Solid>();
  Result<Solid> solid = solidOf(base->body, base->open, mesh, "the input with faces moved");
  if (!solid) return tl::unexpected(solid.error());
  return std::optional<Solid>(std::move(*solid));
}

Result<Parts> takeApart(const Body& in, const std::vector<int>& open, const WallBases& bases,
                        const TessellateOptions& mesh) {
  auto solid = solidOf(in, open, mesh, "the input");
  if (!solid) return tl::unexpected(solid.error());
  auto inner = baseOf(bases.inner, mesh);
  if (!inner) return tl::unexpected(inner.error());
  auto outer = baseOf(bases.outer, mesh);
  if (!outer) return tl::unexpected(outer.error());
  Parts parts{std::move(*solid), std::move(*inner), std::move(*outer), {}};
  const double diagonal = diagonalOf(occtShape(in.shape));
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(occtShape(in.shape), TopAbs_FACE, map);
  for (const int f : std::set<int>(open.begin(), open.end())) {
    const TopoDS_Face face = TopoDS::Face(map(f + 1));
    const BRepAdaptor_Surface surface(face);
    const gp_Pnt2d middle(0.5 * (surface.FirstUParameter() + surface.LastUParameter()),
                          0.5 * (surface.FirstVParameter() + surface.LastVParameter()));
    const std::optional<gp_Vec> normal = outwardNormal(face, middle);
    auto distance = ModelDistance::build({sheetOf({face})}, mesh, "an opening");
    if (!normal) return fail(ErrorCode::Failed, "an opening has no normal");
    if (!distance) return tl::unexpected(distance.error());
    parts.openings.push_back({isPlanar(face, diagonal),
                              toVec3(surface.Value(middle.X(), middle.Y()).XYZ()),
                              toVec3(normal->XYZ()), std::move(*distance)});
  }
  return parts;
}

class ShellMeasure {
 public:
  ShellMeasure(const Parts& parts, const ModelDistance& out, const ShellCheckOptions& options)
      : parts_(parts), out_(out), options_(options) {}

  WallFigures run() {
    SampleRng rng(kAccuracySeed);
    figures_.addSamples(out_, options_.samples, rng, [this](const Vec3& x) { return pointAt(x); });
    measureCoverage();
    return std::move(figures_);
  }

 private:
  /// How far x is from the nearest place where the boundary of the shell may lie.
  [[nodiscard]] WallPoint pointAt(const Vec3& x) const {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    const ShellWalls& walls = options_.walls;
    const double toClosed = parts_.in.closed.distance(x);
    const bool border = std::min(toClosed, nearestOpening(x)) < options_.tolerance;
    const bool inside = parts_.in.all.inside(x);
    double onFarSide = kNone;
    if (walls.inner > 0 && (inside || border))
      onFarSide = std::abs(fromBase(parts_.innerBase, x, toClosed) - walls.inner);
    if (walls.outer > 0 && (!inside || border))
      onFarSide =
          std::min(onFarSide, std::abs(fromBase(parts_.outerBase, x, toClosed) - walls.outer));
    const bool facesStay = walls.inner == 0 || walls.outer == 0;
    double elsewhere = facesStay ? toClosed : kNone;
    const double thickest = options_.bases.thickest;
    const double reach = std::max(thickest, border   ? std::max(walls.inner, walls.outer)
                                            : inside ? walls.inner
                                                     : walls.outer);
    for (const Opening& opening : parts_.openings) {
      if (toClosed > reach + options_.tolerance) break;
      if (opening.face.distance(x) <= kNearOpening * reach)
        elsewhere = std::min(elsewhere, opening.off(x));
    }
    return {std::min(onFarSide, elsewhere), onFarSide <= elsewhere};
  }

  static double fromBase(const std::optional<Solid>& base, const Vec3& x, double otherwise) {
    return base ? base->closed.distance(x) : otherwise;
  }

  double nearestOpening(const Vec3& x) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Opening& opening : parts_.openings)
      nearest = std::min(nearest, opening.face.distance(x));
    return nearest;
  }

  void measureCoverage() {
    SampleRng rng(kCoverageSeed);
    const ShellWalls& walls = options_.walls;
    if (walls.inner == 0 || walls.outer == 0) {
      for (const SurfaceSample& s : samplesOf(parts_.in, rng)) miss(s.point, s.weight);
    }
    if (walls.inner > 0) measureFarSide(parts_.inner(), -walls.inner, rng);
    if (walls.outer > 0) measureFarSide(parts_.outer(), walls.outer, rng);
  }

  [[nodiscard]] std::vector<SurfaceSample> samplesOf(const Solid& solid, SampleRng& rng) const {
    return solid.closed.surfaceSamples(options_.samples, kPerFace, rng);
  }

  /// `side`: the wall, signed as an offset.
  void measureFarSide(const Solid& base, double side, SampleRng& rng) {
    for (const SurfaceSample& s : samplesOf(base, rng))
      mustBe(s.point + side * s.normal, base, side, s.weight);
    RoundingDensity density;
    density.perArea = options_.samples / base.closed.area();
    for (const OffsetCandidate& c : roundingCandidates(base.closed.shape(0), side, density, rng))
      mustBe(c.point, base, side, c.weight);
  }

  /// q is a point of a wall's far side unless something is nearer or the wall has ended.
  void mustBe(const Vec3& q, const Solid& base, double side, double weight) {
    const double wall = std::abs(side);
    const ModelDistance& closed = base.closed;
    if (closed.meshDistance(q) < wall * (1 - kLooseKeep) - 4 * closed.deflection()) return;
    if (closed.distance(q) < wall * (1 - kLooseKeep)) return;
    if (base.all.inside(q) != (side < 0)) return;
    if (side < 0 && !parts_.in.all.inside(q)) return;  // the base goes on beyond openings
    for (const Opening& opening : parts_.openings) {
      const double near = opening.face.distance(q);
      const bool ended =
          opening.planar ? opening.height(q) > -kLooseKeep * wall : near < kLooseKeep * wall;
      if (ended && near < kNearOpening * wall) return;
    }
    miss(q, weight);
  }

  void miss(const Vec3& q, double weight) { figures_.addMissing(q, out_.distance(q), weight); }

  const Parts& parts_;
  const ModelDistance& out_;
  const ShellCheckOptions& options_;
  WallFigures figures_;
};

Result<CheckResult> measure(const Body& in, const std::vector<int>& open,
                            const std::vector<Body>& out, const ShellCheckOptions& options) {
  const TessellateOptions mesh = wallMesh(in, options);
  const Result<Parts> parts = takeApart(in, open, options.bases, mesh);
  if (!parts) return tl::unexpected(parts.error());

  CheckResult result;
  const std::optional<ModelDistance> distance = measurableWall(out, mesh, result);
  if (!distance) return result;
  judgeWalls(ShellMeasure(*parts, *distance, options).run(), options.tolerance, result);
  return result;
}

}  // namespace

Result<CheckResult> checkBodyShell(const Body& in, const std::vector<int>& open,
                                   const std::vector<Body>& out, const ShellCheckOptions& options) {
  return checkInChild(options.timeLimit, [&] { return measure(in, open, out, options); });
}

}  // namespace phront::cad
