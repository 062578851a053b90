// The feature table of a shape: what its faces, edges and vertices are.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <memory>
#include <vector>

#include "phront/cad/tessellate.h"
#include "tessellate/face_surface.h"
#include "tessellate/occt_mesh.h"

namespace phront::cad {

/// One use of an edge by a face.
struct EdgeUse {
  TopoDS_Face face;
  TopoDS_Edge edge;  ///< oriented as in the oriented face
  Index faceIndex = kNone;
};

/// Surfaces of all faces and uses of all edges of a shape, by number.
struct ShapeIndex {
  explicit ShapeIndex(const TopoDS_Shape& shape);
  ShapeMaps maps;
  std::vector<std::unique_ptr<FaceSurface>> surfaces;
  std::vector<std::vector<EdgeUse>> uses;  ///< per edge
};

struct FeatureOptions {
  double smoothAngle = 1e-3;  ///< rad, largest dihedral of a smooth edge
  double planeTolerance = 0;  ///< mm
};

struct ShapeFeatures {
  FeatureTable table;             ///< areas, lengths and names are left to the caller
  std::vector<bool> sharpVertex;  ///< touches a sharp edge or is an apex
};

[[nodiscard]] ShapeFeatures shapeFeatures(const ShapeIndex& index, const FeatureOptions& options);

[[nodiscard]] inline bool isSharp(EdgeType type) { return type != EdgeType::Smooth; }

}  // namespace phront::cad
