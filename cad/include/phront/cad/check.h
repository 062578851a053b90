// Measures whether OUT is the offset of IN at distance d: the judge phront puts before its own
// door.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "phront/cad/shape.h"
#include "phront/progress.h"
#include "phront/status.h"

namespace phront::cad {

/// The check holds results to this share of every bound (tolerance, share of area beyond it, share
/// on the wrong side), so that other random samples do not come to another verdict.
inline constexpr double kCheckStrictness = 0.8;

/// What an offset does round edges and corners where it would gape. Arc: rounded, every point at
/// the distance |d|. Mitre: the faces beside them are extended until they meet.
enum class Join { Arc, Mitre };

/// Of a mitre: how far its corners may be from the part, in |d|. Sharper ones stay round. 2 is an
/// edge of 60 degrees, sqrt(2) that of a box and sqrt(3) its corner.
inline constexpr double kMitreLimit = 2;

struct CheckOptions {
  double distance = 0;  ///< d, mm, signed
  Join join = Join::Arc;
  double mitreLimit = kMitreLimit;  ///< > 1
  std::optional<double> tolerance =
      std::nullopt;       ///< mm, bound on 99th percentiles; default 1 % of |d|
  int samples = 20'000;   ///< over the whole surface, and at least 20 on each face
  double timeLimit = 60;  ///< s, for the guarded child that measures
  /// Also tessellate OUT as other programs do, without the care that measuring takes: a face that
  /// gets no triangles there is a fault.
  bool meshPlainly = true;
};

/// All lengths in mm. "accuracy" samples OUT against the true IN; "coverage" samples the true
/// offset, built from IN alone, against OUT.
struct CheckResult {
  int solids = 0;
  int shells = 0;
  int faces = 0;
  bool valid = false;      ///< BRepCheck
  bool closed = false;     ///< every edge used exactly twice in its shell
  double volume = 0;       ///< mm^3
  double accuracyP99 = 0;  ///< 99th percentile of | dist(OUT, IN) - |d| |, by area
  double accuracyMax = 0;
  double coverageP99 = 0;
  double coverageMax = 0;
  double rightSide = 1;          ///< share of OUT's area on the right side of IN
  double buried = 0;             ///< share of OUT's area inside OUT: solids that overlap
  bool trueOffsetEmpty = false;  ///< no point of IN has an offset: the right answer is "nothing"
  int untessellatedFaces = 0;
  Vec3 worstPoint = Vec3::Zero();
  std::vector<std::string> reasons;  ///< why it fails; empty when it passes
  [[nodiscard]] bool pass() const { return reasons.empty(); }
  /// Topology and tessellation are right, whatever the distances are.
  [[nodiscard]] bool sound() const { return valid && closed && untessellatedFaces == 0; }
};

/// Independent of how OUT was made. An empty OUT model asks "is the true offset empty?".
/// Passes when OUT is valid; closed with positive volume in every solid; when 99 % of its area and
/// of the true offset deviate by at most `tolerance`, no point by more than 10 times that, no edge
/// or vertex bridges a gap wider than those 10 times, and 99.9 % of the area is on the right side
/// and 99.8 % not inside OUT itself; all of it times kCheckStrictness. Single points are searched
/// for, not only sampled. With an arc join rounded edges are what is right; with a mitre points may
/// be up to `mitreLimit` |d| from the part within that distance of an edge that the offset goes
/// round, and no offset is asked of edges and vertices. The same input gives the same figures.
/// Sheets are judged one-sided: no sidedness, no closedness. Guarded: never crashes or hangs. Fails
/// with InvalidArgument (d = 0 or NaN), Failed (IN cannot be tessellated), ResourceLimit.
[[nodiscard]] Result<CheckResult> checkOffset(const Model& in, const Model& out,
                                              const CheckOptions& options,
                                              const Progress& progress = {});

}  // namespace phront::cad
