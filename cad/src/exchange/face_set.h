// Faces that make up a shell: how their edges are used, and repairs that keep their order.
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <TopoDS_Shell.hxx>
#include <vector>

namespace phront::cad {

using FaceSet = std::vector<TopoDS_Face>;

/// Faces of a shape with their orientation in it, in order, repeated ones included.
[[nodiscard]] FaceSet facesOf(const TopoDS_Shape& shape);

/// Degenerated, internal and external edges do not count.
struct EdgeUse {
  int edges = 0;
  int freeEdges = 0;      ///< used once
  int overusedEdges = 0;  ///< used more than twice
  int clashingEdges = 0;  ///< used twice in the same direction: one of the faces is inside out
  [[nodiscard]] bool closed() const { return edges > 0 && freeEdges == 0 && overusedEdges == 0; }
};
[[nodiscard]] EdgeUse edgeUse(const FaceSet& faces);

/// Removes faces that are there already: the same face, or one with the same edges where these are
/// used more than twice. Returns how many.
int dropDuplicates(FaceSet& faces);

/// Turns faces until neighbours agree, as few as possible. Returns how many, or -1 when no choice
/// makes all agree (a Moebius band); then nothing is changed.
int orientAlike(FaceSet& faces);

/// Connected through edges; components and faces keep the order of the set.
[[nodiscard]] std::vector<FaceSet> componentsOf(const FaceSet& faces);

[[nodiscard]] TopoDS_Shell shellOf(const FaceSet& faces);

}  // namespace phront::cad
