// How far OUT is from where it should be, and what of the true offset it lacks.
//
// Percentiles come from stratified samples with exact distances on both sides. A maximum cannot be
// had by sampling alone: a defect that covers little of a face is easily missed. So ten times as
// many points are first measured against the triangles only (microseconds each), the worst of them
// exactly, and from the worst of all a random local search climbs over the face to the top (pure
// random search with shrinking radius, Solis & Wets 1981). The same search answers whether anything
// is left of a part that seems to vanish: it climbs to the point whose offset is farthest from IN.
// A point p + d n is kept as part of the true offset when its distance to IN is |d|; features are
// never asked which of them cut it off.
// Weak spots: a slot or wall within 1.2e-3 |d| of closing or vanishing is read as open; defects
// both smaller than the sampling and not reached by the climb are missed.
#include "judge/check_measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "judge/mitre_reach.h"

namespace phront::cad {
namespace {

constexpr int kPerFace = 20;          // fewest samples on a face of an ordinary part
constexpr int kMostByFaces = 60'000;  // together, where there are thousands of faces
constexpr int kSearchFactor = 10;     // search points per sample, measured against triangles
constexpr int kMostSearched = 300'000;
constexpr int kMostExact = 600;  // search points measured exactly
constexpr int kClimbs = 12;
constexpr int kClimbRounds = 5;
constexpr int kClimbTries = 8;
constexpr int kSideSamples = 6000;
// Fewer sampled points than this do not prove that something is left: other samples find none.
// Among many more points it takes as many more, so that an ordinary number of samples finds some.
constexpr int kFewestKept = 5;
constexpr int kConfirmingSamples = 300'000;
constexpr int kFewestConfirming = 60;
constexpr double kLooseKeep = 1.2e-3;  // of |d|: nearer to IN than this below |d| is cut off
constexpr double kExact = 1e-6;        // of |d|: no need to ask whether a mitre explains it
constexpr double kFirmKeep = 0.8e-3;   // of |d|: certainly not cut off
constexpr double kSuspicious = 0.3;    // of the maximum: below, a search point is not pursued
constexpr double kMeshSlack = 4;       // times the measured deflection: error of triangle distances

int perFace(int faces, int wanted, int most) {
  return std::clamp(most / std::max(faces, 1), 2, wanted);
}

struct Scored {
  SurfaceSample sample;
  double score = 0;
};

/// The worst first; equal ones in the order they were drawn.
void sortByScore(std::vector<Scored>& items) {
  std::stable_sort(items.begin(), items.end(),
                   [](const Scored& a, const Scored& b) { return a.score > b.score; });
}

/// Climbs on the face of `start` towards larger `score(sample)`.
template <class Score>
Scored climb(const ModelDistance& model, Scored start, const Score& score, SampleRng& rng) {
  const SurfaceDistance& surface = model.body(start.sample.body).surface();
  const Index face = surface.mesh().face(start.sample.triangle);
  const double faceArea = model.body(start.sample.body)
                              .tessellation()
                              .features.faces[static_cast<std::size_t>(face)]
                              .area;
  double radius = 0.3 * std::sqrt(faceArea);
  Scored best = std::move(start);
  for (int round = 0; round < kClimbRounds; ++round, radius *= 0.3) {
    const Vec3 centre = best.sample.point;
    for (int i = 0; i < kClimbTries; ++i) {
      const Vec3 step(2 * rng() - 1, 2 * rng() - 1, 2 * rng() - 1);
      const FootPoint foot = surface.footOnFace(centre + radius * step, face);
      if (foot.triangle == kNone) continue;
      Scored next{model.sampleAt(best.sample.body, foot.triangle, foot.barycentric), 0};
      next.score = score(next.sample);
      if (next.score > best.score) best = std::move(next);
    }
  }
  return best;
}

/// Climbs from the first of `seeds`, which are sorted; the best of all.
template <class Score>
Scored climbAll(const ModelDistance& model, const std::vector<Scored>& seeds, const Score& score,
                SampleRng& rng) {
  Scored best;
  for (std::size_t i = 0; i < seeds.size() && i < kClimbs; ++i) {
    Scored top = climb(model, seeds[i], score, rng);
    if (i == 0 || top.score > best.score) best = std::move(top);
  }
  return best;
}

int searchCount(const MeasureOptions& options) {
  return std::min(kSearchFactor * options.samples, kMostSearched);
}

std::vector<SurfaceSample> statisticSamples(const ModelDistance& model,
                                            const MeasureOptions& options, SampleRng& rng) {
  return model.surfaceSamples(options.samples, perFace(model.faces(), kPerFace, kMostByFaces), rng);
}

std::vector<SurfaceSample> searchSamples(const ModelDistance& model, const MeasureOptions& options,
                                         SampleRng& rng) {
  return model.surfaceSamples(searchCount(options),
                              perFace(model.faces(), kSearchFactor * kPerFace, kMostSearched), rng);
}

std::optional<MitreReach> reachOf(const ModelDistance& in, const MeasureOptions& options) {
  if (!options.mitreLimit) return std::nullopt;
  return MitreReach(in, options.distance, *options.mitreLimit);
}

/// What remains of the offset of IN, point by point.
class TrueOffset {
 public:
  TrueOffset(const ModelDistance& in, const MeasureOptions& options)
      : in_(in), distance_(options.distance), mitre_(reachOf(in, options)) {}

  [[nodiscard]] Vec3 of(const SurfaceSample& s) const { return s.point + distance_ * s.normal; }

  /// Cheap: false only for points that kept() refuses, too.
  [[nodiscard]] bool mayBeKept(const Vec3& q) const {
    return in_.meshDistance(q) + kMeshSlack * in_.deflection() >= bound(kLooseKeep);
  }
  [[nodiscard]] double reach(const Vec3& q) const { return in_.distance(q); }
  [[nodiscard]] bool kept(double reach) const { return reach >= bound(kLooseKeep); }
  [[nodiscard]] bool firm(double reach) const { return reach >= bound(kFirmKeep); }
  /// How far OUT misses q, a point above a face or edge of `body`. Where an edge of IN lies off its
  /// faces, q is farther than |d| from IN, and as much off the true offset, too. Corners of a mitre
  /// may cover q.
  [[nodiscard]] double missed(const Vec3& q, double reach, std::size_t body,
                              const ModelDistance& out) const {
    const double error =
        std::max(0.0, out.distance(q) - std::max(0.0, reach - std::abs(distance_)));
    if (error <= kLooseKeep * std::abs(distance_)) return error;
    // In a narrow groove q may lie behind the other wall, as far from it as from its own. In
    // another body it counts: where bodies touch, each has its own surface.
    if (in_.isSolid(body) && in_.inside(body, q) != (distance_ < 0)) return 0;
    const bool covered = mitre_ && mitre_->holds(q) && out.inside(q) == (distance_ > 0);
    return covered ? 0 : error;
  }
  [[nodiscard]] bool rightSide(const Vec3& q) const {
    return !in_.hasSolids() || in_.inside(q) == (distance_ < 0);
  }

 private:
  [[nodiscard]] double bound(double slack) const { return std::abs(distance_) * (1 - slack); }

  const ModelDistance& in_;
  double distance_;
  std::optional<MitreReach> mitre_;
};

/// Collects what coverage samples say.
class CoverageTally {
 public:
  CoverageTally(const ModelDistance* out, const MeasureOptions& options)
      : out_(out), options_(options) {}

  /// Returns the distance to OUT (0 without one).
  double add(const Vec3& q, double reach, std::size_t body, const TrueOffset& offset,
             double weight) {
    if (figures.kept == 0) figures.anyKept = q;
    ++figures.kept;
    if (offset.firm(reach)) ++figures.firm;
    if (out_ == nullptr) return 0;
    const double error = offset.missed(q, reach, body, *out_);
    errors_.add(error, weight);
    raise(error, q);
    return error;
  }

  void raise(double error, const Vec3& q) {
    if (error > figures.max) {
      figures.max = error;
      figures.worst = q;
    }
  }

  void finish() {
    figures.p99 = errors_.quantile(0.99);
    figures.shareBeyond = errors_.shareAbove(options_.tolerance);
  }

  CoverageFigures figures;

 private:
  const ModelDistance* out_;
  const MeasureOptions& options_;
  WeightedErrors errors_;
};

/// Adds the points of the true offset above `samples`; returns the area they stand for, and puts
/// what is worth climbing from into `seeds`.
double tallyFaces(const std::vector<SurfaceSample>& samples, const TrueOffset& offset,
                  CoverageTally& tally, std::vector<Scored>& seeds) {
  double kept = 0;
  for (const SurfaceSample& s : samples) {
    const Vec3 q = offset.of(s);
    if (!offset.mayBeKept(q)) continue;
    const double reach = offset.reach(q);
    if (!offset.kept(reach)) continue;
    kept += s.weight;
    seeds.push_back({s, tally.add(q, reach, s.body, offset, s.weight)});
  }
  return kept;
}

/// Do edges and vertices have an offset of their own?
bool hasRounding(const ModelDistance& in, const MeasureOptions& options) {
  return in.hasSolids() && !options.mitreLimit;
}

/// Sampled points first; returns those worth climbing from.
std::vector<Scored> tallySamples(const ModelDistance& in, const TrueOffset& offset,
                                 const MeasureOptions& options, CoverageTally& tally,
                                 SampleRng& rng) {
  std::vector<Scored> seeds;
  tally.figures.keptShare =
      tallyFaces(statisticSamples(in, options, rng), offset, tally, seeds) / in.area();
  RoundingDensity density;
  density.perArea = options.samples / in.area();
  for (std::size_t b = 0; hasRounding(in, options) && b < in.bodyCount(); ++b) {
    for (const OffsetCandidate& c :
         roundingCandidates(in.shape(b), options.distance, density, rng)) {
      if (!offset.mayBeKept(c.point)) continue;
      const double reach = offset.reach(c.point);
      if (offset.kept(reach) && offset.rightSide(c.point)) {
        tally.add(c.point, reach, b, offset, c.weight);
      }
    }
  }
  tally.figures.confirmed = tally.figures.kept >= kFewestKept;
  if (tally.figures.kept > 0 && !tally.figures.confirmed) {
    tallyFaces(in.surfaceSamples(kConfirmingSamples, 1, rng), offset, tally, seeds);
    tally.figures.confirmed = tally.figures.kept >= kFewestConfirming;
  }
  return seeds;
}

/// Looks for the point of the true offset that lies farthest from OUT.
void searchUncovered(const ModelDistance& in, const ModelDistance& out, const TrueOffset& offset,
                     const MeasureOptions& options, std::vector<Scored> seeds, CoverageTally& tally,
                     SampleRng& rng) {
  const double floor = kSuspicious * options.maxTolerance;
  std::vector<Scored> suspects;
  for (const SurfaceSample& s : searchSamples(in, options, rng)) {
    const Vec3 q = offset.of(s);
    const double error = out.meshDistance(q);
    if (error > floor && offset.mayBeKept(q)) suspects.push_back({s, error});
  }
  sortByScore(suspects);
  int exact = 0;
  for (const Scored& suspect : suspects) {
    if (++exact > kMostExact) break;
    const Vec3 q = offset.of(suspect.sample);
    const double reach = offset.reach(q);
    if (!offset.kept(reach)) continue;
    const double error = offset.missed(q, reach, suspect.sample.body, out);
    tally.raise(error, q);
    seeds.push_back({suspect.sample, error});
  }
  sortByScore(seeds);
  const auto uncovered = [&](const SurfaceSample& s) {
    const Vec3 q = offset.of(s);
    if (!offset.mayBeKept(q)) return 0.0;
    const double reach = offset.reach(q);
    return offset.kept(reach) ? offset.missed(q, reach, s.body, out) : 0.0;
  };
  if (!seeds.empty()) {
    const Scored top = climbAll(in, seeds, uncovered, rng);
    tally.raise(top.score, offset.of(top.sample));
  }

  RoundingDensity denser;
  denser.perArea = 3 * options.samples / in.area();
  denser.perVertex = 200;
  for (std::size_t b = 0; hasRounding(in, options) && b < in.bodyCount(); ++b) {
    for (const OffsetCandidate& c :
         roundingCandidates(in.shape(b), options.distance, denser, rng)) {
      if (out.meshDistance(c.point) <= floor || !offset.mayBeKept(c.point)) continue;
      const double reach = offset.reach(c.point);
      if (!offset.kept(reach) || !offset.rightSide(c.point)) continue;
      tally.raise(offset.missed(c.point, reach, b, out), c.point);
      if (tally.figures.max > options.maxTolerance) return;
    }
  }
}

/// Looks for any point of the true offset when the samples found none: climbs to the one whose
/// offset is farthest from IN.
void searchRemains(const ModelDistance& in, const TrueOffset& offset, const MeasureOptions& options,
                   CoverageTally& tally, SampleRng& rng) {
  std::vector<Scored> seeds;
  for (const SurfaceSample& s : searchSamples(in, options, rng)) {
    seeds.push_back({s, in.meshDistance(offset.of(s))});
  }
  sortByScore(seeds);
  if (seeds.size() > kMostExact) seeds.resize(kMostExact);
  const auto reach = [&](const SurfaceSample& s) { return offset.reach(offset.of(s)); };
  for (Scored& seed : seeds) seed.score = reach(seed.sample);
  sortByScore(seeds);
  if (seeds.empty()) return;
  const Scored top = climbAll(in, seeds, reach, rng);
  if (offset.kept(top.score)) {
    ++tally.figures.found;
    tally.figures.anyKept = offset.of(top.sample);
  }
}

/// Where phi > 0; nullopt beside the edges of a sheet.
std::optional<bool> isOutside(const ModelDistance& in, const Vec3& x) {
  if (in.hasSolids()) return !in.inside(x);
  return in.beforeSheet(x);
}

}  // namespace

AccuracyFigures measureAccuracy(const ModelDistance& in, const ModelDistance& out,
                                const MeasureOptions& options, SampleRng& rng) {
  const double wanted = std::abs(options.distance);
  const std::optional<MitreReach> mitre = reachOf(in, options);
  const auto errorAt = [&](const Vec3& x, double distance) {
    const double error = std::abs(distance - wanted);
    if (!mitre || distance - wanted <= kExact * wanted || !mitre->holds(x)) return error;
    return std::max(0.0, distance - mitre->farthest());
  };
  const auto error = [&](const SurfaceSample& s) { return errorAt(s.point, in.distance(s.point)); };
  AccuracyFigures figures;
  WeightedErrors errors;
  std::vector<Scored> seeds;
  double right = 0;
  double sided = 0;
  double buried = 0;
  const std::vector<SurfaceSample> samples = statisticSamples(out, options, rng);
  const std::size_t stride = samples.size() / kSideSamples + 1;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const SurfaceSample& s = samples[i];
    seeds.push_back({s, error(s)});
    errors.add(seeds.back().score, s.weight);
    if (i % stride != 0) continue;
    if (out.buried(s.body, s.triangle)) buried += s.weight;
    const std::optional<bool> outside = isOutside(in, s.point);
    if (!outside) continue;
    sided += s.weight;
    if (*outside == (options.distance > 0)) right += s.weight;
  }
  if (sided > 0) {
    figures.rightSide = right / sided;
    figures.buried = buried / sided;
  }
  figures.p99 = errors.quantile(0.99);
  figures.shareBeyond = errors.shareAbove(options.tolerance);

  if (seeds.empty()) return figures;
  sortByScore(seeds);
  figures.max = seeds.front().score;
  figures.worst = seeds.front().sample.point;
  if (!options.search || figures.max > options.maxTolerance) return figures;

  const double floor = kSuspicious * options.maxTolerance;
  std::vector<Scored> suspects;
  for (const SurfaceSample& s : searchSamples(out, options, rng)) {
    const double meshError = errorAt(s.point, in.meshDistance(s.point));
    if (meshError > floor) suspects.push_back({s, meshError});
  }
  sortByScore(suspects);
  if (suspects.size() > kMostExact) suspects.resize(kMostExact);
  for (const Scored& suspect : suspects) seeds.push_back({suspect.sample, error(suspect.sample)});
  sortByScore(seeds);
  const Scored top = climbAll(out, seeds, error, rng);
  figures.max = top.score;
  figures.worst = top.sample.point;
  return figures;
}

CoverageFigures measureCoverage(const ModelDistance& in, const ModelDistance* out,
                                const MeasureOptions& options, SampleRng& rng) {
  const TrueOffset offset(in, options);
  CoverageTally tally(out, options);
  std::vector<Scored> seeds = tallySamples(in, offset, options, tally, rng);
  if (tally.figures.kept == 0) {
    searchRemains(in, offset, options, tally, rng);
  } else if (out != nullptr && options.search && tally.figures.max <= options.maxTolerance) {
    searchUncovered(in, *out, offset, options, std::move(seeds), tally, rng);
  }
  tally.finish();
  return std::move(tally.figures);
}

}  // namespace phront::cad
