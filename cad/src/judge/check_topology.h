// What a result must be before any distance is measured: valid, closed, with positive volume.
#pragma once

#include <TopoDS_Shape.hxx>
#include <vector>

#include "phront/types.h"

namespace phront::cad {

struct TopologyFigures {
  int solids = 0;
  int shells = 0;
  int faces = 0;
  bool valid = false;     ///< BRepCheck_Analyzer, with geometry
  int freeEdges = 0;      ///< used once in their shell
  int overusedEdges = 0;  ///< used more than twice in their shell
  int looseFaces = 0;     ///< in no shell
  double volume = 0;      ///< mm^3, sum over the solids
  int untessellated = 0;  ///< faces that OpenCASCADE's mesher gives no triangles for
  int badSolids = 0;      ///< solids whose volume is not positive or larger than their box
  double widestGap = 0;   ///< mm, between faces where an edge or vertex joins them
  Vec3 atGap = Vec3::Zero();

  /// Every edge used exactly twice in its shell, no face outside a shell.
  [[nodiscard]] bool closed() const {
    return shells > 0 && faces > 0 && freeEdges == 0 && overusedEdges == 0 && looseFaces == 0;
  }
};

/// May throw, hang or crash with OpenCASCADE on a bad shape: call it in runInChild.
[[nodiscard]] TopologyFigures measureTopology(const TopoDS_Shape& shape);

/// How finely faces are tessellated.
struct MeshSize {
  double deflection;  ///< mm
  double angle;       ///< rad, between neighbouring normals
};

/// What an offset is measured on.
struct OffsetScale {
  double diagonal;  ///< mm, of the part
  double distance;  ///< mm
  bool solid;       ///< has roundings of radius |distance|; sheets get none
};

/// The smaller of the two shares, but finite in number for tiny distances. There roundings are
/// divided no finer than the deflection asks: an edge of many thousand |d| would else be cut into
/// as many slivers.
[[nodiscard]] MeshSize meshSize(const OffsetScale& scale, double shareOfDiagonal,
                                double shareOfDistance);

/// What a user's programs tessellate such an offset with.
[[nodiscard]] MeshSize usualMeshSize(const OffsetScale& scale);

/// Faces (numbers in TopExp_Explorer's order) that OpenCASCADE's mesher gives no triangles for, or
/// such as fold over the face, when it is called plainly: what needs special care to be meshed here
/// fails elsewhere. All faces when the mesher crashes; where it takes long, those that fail at
/// their outlines. Leaves no triangles on the shape.
[[nodiscard]] std::vector<int> facesWithoutTriangles(const TopoDS_Shape& shape,
                                                     const MeshSize& size);

}  // namespace phront::cad
