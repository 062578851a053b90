#include "judge/check_thick.h"

#include <GCPnts_AbscissaPoint.hxx>
#include <algorithm>
#include <cmath>

#include "judge/check_sampling.h"
#include "judge/thick_sheet.h"
#include "judge/wall_verdict.h"
#include "phront/cad/shape_occt.h"

namespace phront::cad {
namespace {

constexpr double kLooseKeep = 1.2e-3;  // of the height: nearer to the sheet than this is cut off
constexpr int kPerFace = 20;
constexpr int kPerEdge = 40;  // at least
constexpr std::uint64_t kAccuracySeed = 0x9fb21c651e98df25;
constexpr std::uint64_t kCoverageSeed = 0xe7037ed1a0b428db;

class ThickMeasure {
 public:
  ThickMeasure(const ModelDistance& sheet, const FreeBorder& border, const ModelDistance& out,
               const ShellCheckOptions& options)
      : sheet_(sheet),
        border_(border),
        out_(out),
        options_(options),
        thick_(sheet.body(0), border, options.walls) {}

  WallFigures run() {
    SampleRng accuracyRng(kAccuracySeed);
    figures_.addSamples(out_, options_.samples, accuracyRng,
                        [this](const Vec3& x) { return thick_.offBoundary(x); });
    SampleRng rng(kCoverageSeed);
    coverSides(rng);
    coverWalls(rng);
    return std::move(figures_);
  }

 private:
  void coverSides(SampleRng& rng) {
    const double heights[] = {-options_.walls.inner, options_.walls.outer};
    for (const SurfaceSample& s : sheet_.surfaceSamples(options_.samples, kPerFace, rng))
      for (const double height : heights) mustBe(s.point + height * s.normal, height, s.weight);
    RoundingDensity density;
    density.perArea = options_.samples / sheet_.area();
    for (const double height : heights) {
      if (height == 0) continue;
      for (const OffsetCandidate& c : roundingCandidates(sheet_.shape(0), height, density, rng))
        if (!sheet_.body(0).foot(c.point).beyondBorder) mustBe(c.point, height, c.weight);
    }
  }

  void coverWalls(SampleRng& rng) {
    const ShellWalls& walls = options_.walls;
    const double perArea = options_.samples / sheet_.area();
    for (const FreeEdge& edge : border_.edges()) {
      const double area = GCPnts_AbscissaPoint::Length(edge.curve()) * walls.thickness();
      const int count =
          std::clamp(static_cast<int>(std::min(area * perArea, 1e6)), kPerEdge, options_.samples);
      for (int i = 0; i < count; ++i) {
        const double share = (i + rng()) / count;
        const double height = walls.thickness() * rng() - walls.inner;
        const std::optional<BorderPoint> b =
            edge.at(edge.first() + share * (edge.last() - edge.first()));
        if (b) mustBe(b->point + height * b->normal, height, area / count);
      }
    }
  }

  /// q is a point of the boundary unless the sheet is nearer than that.
  void mustBe(const Vec3& q, double height, double weight) {
    if (sheet_.distance(q) < std::abs(height) * (1 - kLooseKeep)) return;
    figures_.addMissing(q, out_.distance(q), weight);
  }

  const ModelDistance& sheet_;
  const FreeBorder& border_;
  const ModelDistance& out_;
  const ShellCheckOptions& options_;
  const ThickSheet thick_;
  WallFigures figures_;
};

Result<CheckResult> measure(const Body& in, const std::vector<Body>& out,
                            const ShellCheckOptions& options) {
  const TessellateOptions mesh = wallMesh(in, options);
  const auto sheet = ModelDistance::build({in}, mesh, "the sheet");
  if (!sheet) return tl::unexpected(sheet.error());
  const FreeBorder border(occtShape(in.shape), mesh.deflection);

  CheckResult result;
  const std::optional<ModelDistance> distance = measurableWall(out, mesh, result);
  if (!distance) return result;
  judgeWalls(ThickMeasure(*sheet, border, *distance, options).run(), options.tolerance, result);
  return result;
}

}  // namespace

Result<CheckResult> checkThickSheet(const Body& in, const std::vector<Body>& out,
                                    const ShellCheckOptions& options) {
  return checkInChild(options.timeLimit, [&] { return measure(in, out, options); });
}

}  // namespace phront::cad
