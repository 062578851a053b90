// One attempt at the offset by exact patches: raw complex, General Fuse, phi decides, MakerVolume.
#pragma once

#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "phront/status.h"
#include "tessellate/true_distance.h"

namespace phront::cad {

/// One way to try. Several are tried, each judged; the first that passes wins.
struct AttemptSetting {
  std::string name;              ///< shown in the report
  double fuzzy = 0;              ///< of the diagonal, General Fuse
  double smoothTolerance = 0;    ///< of |d|: an edge with dihedral angle below is smooth
  double sewTolerance = 0;       ///< of the diagonal; 0: kept faces are not sewn
  bool unifyInput = false;       ///< merge split faces of the input first
  bool dropDeadPatches = false;  ///< drop patches that no label of the iso-surface names
  bool thinPairs = false;        ///< patches that cannot cross on the offset are not intersected
  /// Edges whose pipes fold are divided where they bend most; without such edges the attempt fails.
  bool dividesBends = false;
  /// Patches whose pieces stay open are intersected with their neighbours, too, in a second cut.
  bool looksAgain = false;
  /// s, > 0: the pieces are cut where phi shows that they leave the offset, even if they close, for
  /// at most so long. For when earlier settings failed.
  double repairSeconds = 0;
  /// Share of |d| at which the offset is made. At d itself parts of it may touch or be of no width,
  /// as where a slot just closes, which no solid can have; a little before it is one, within the
  /// tolerance. Patches that General Fuse cuts badly at d often are cut well there.
  double reach = 1;
  double timeLimit = 15;  ///< s
};

/// The settings in the order they are tried.
[[nodiscard]] std::vector<AttemptSetting> attemptSettings();

struct AttemptResult {
  TopoDS_Shape shape;   ///< solids (or a sheet); null when nothing is left, or nothing closes
  TopoDS_Shape pieces;  ///< what of all patches lies on the offset of a solid
  std::string fault;    ///< why pieces of a solid do not close; empty when they do
  int rawFaces = 0;
  int splitFaces = 0;
  int keptFaces = 0;
  int openEdges = 0;
  int fittedFaces = 0;             ///< patches that close gaps between the exact ones
  std::vector<std::string> notes;  ///< healing done, faces given up: one sentence each
};

/// Runs in the calling process and may throw, hang or crash with OpenCASCADE: call it in
/// runInChild. `distance` signed, mm. `solid`: closed result wanted; else a sheet on the side of
/// the normals. Fails where there are no pieces to speak of.
[[nodiscard]] Result<AttemptResult> tryExactOffset(const TopoDS_Shape& body, bool solid,
                                                   double distance, const TrueDistance& phi,
                                                   const AttemptSetting& setting);

}  // namespace phront::cad
