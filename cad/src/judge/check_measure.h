// The figures of the check: accuracy, side and coverage of one result against one input.
#pragma once

#include <optional>

#include "judge/check_sampling.h"

namespace phront::cad {

struct MeasureOptions {
  double distance = 0;      ///< d, mm, signed
  double tolerance = 0;     ///< mm, what shares are counted above
  double maxTolerance = 0;  ///< mm, what single points are held to: guides the search for outliers
  int samples = 20'000;
  /// Mitre join: near edges that the offset goes round its points may be up to so many |d| from the
  /// part, and edges and vertices have no offset of their own.
  std::optional<double> mitreLimit = std::nullopt;
  bool search = true;  ///< for single points far off; false: the samples' maximum is enough
};

struct AccuracyFigures {
  double p99 = 0;  ///< of | dist(OUT, IN) - |d| |, by area
  double max = 0;
  double shareBeyond = 0;  ///< of OUT's area with an error above the tolerance
  double rightSide = 1;    ///< of OUT's area
  double buried = 0;       ///< of OUT's area: inside OUT, which overlaps itself there
  Vec3 worst = Vec3::Zero();
};

struct CoverageFigures {
  double p99 = 0;  ///< distance of the true offset to OUT, by area
  double max = 0;
  double shareBeyond = 0;
  int kept = 0;            ///< sampled points of the true offset
  int firm = 0;            ///< those clearly at the full distance
  int found = 0;           ///< further ones that the search for the most distant points brought up
  bool confirmed = false;  ///< kept are enough to say that something is left
  double keptShare = 0;    ///< of IN's area whose offset survives
  Vec3 worst = Vec3::Zero();
  Vec3 anyKept = Vec3::Zero();
};

/// Samples of OUT against IN.
[[nodiscard]] AccuracyFigures measureAccuracy(const ModelDistance& in, const ModelDistance& out,
                                              const MeasureOptions& options, SampleRng& rng);

/// Points of the true offset, built from IN alone, against OUT; `out` null: only whether there are
/// any.
[[nodiscard]] CoverageFigures measureCoverage(const ModelDistance& in, const ModelDistance* out,
                                              const MeasureOptions& options, SampleRng& rng);

}  // namespace phront::cad
