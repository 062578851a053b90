// Watertight labelled tessellation of a body, and the table of its features.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "phront/cad/shape.h"
#include "phront/facet.h"
#include "phront/status.h"
#include "phront/tri_mesh.h"

namespace phront::cad {

enum class SurfaceType {
  Plane,
  Cylinder,
  Cone,
  Sphere,
  Torus,
  Revolution,
  Extrusion,
  Bspline,
  Other
};
enum class EdgeType { Smooth, Convex, Concave, Mixed, Free, NonManifold };

struct FaceFeature {
  SurfaceType type = SurfaceType::Other;
  std::optional<Plane> plane;  ///< if planar: outward plane (normal towards phi > 0)
  double area = 0;             ///< mm^2, of the triangles
  double deflection = 0;       ///< mm, measured distance of its triangles from the surface
  std::string name;
};

struct EdgeFeature {
  EdgeType type = EdgeType::Smooth;
  std::vector<Index> faces;  ///< faces on it (one face twice for a seam)
  double maxDihedral = 0;    ///< rad, largest |angle between face normals| along the edge
  double length = 0;         ///< mm
};

struct VertexFeature {
  Vec3 point = Vec3::Zero();
};

/// Features in the order of the shape: face i is the i-th face of TopExp::MapShapes.
struct FeatureTable {
  std::vector<FaceFeature> faces;
  std::vector<EdgeFeature> edges;
  std::vector<VertexFeature> vertices;
};

struct TessellateOptions {
  double deflection = 0;  ///< mm, > 0: largest distance of the triangles from the surface
  double angle = 0.35;    ///< rad, largest angle between neighbouring triangles on curved faces
  double smoothTolerance =
      0;                  ///< mm: an edge is smooth when |d| * dihedral stays below; see distance
  double distance = 0;    ///< mm, the |d| that smoothTolerance refers to; 0: smooth below 1e-3 rad
  double timeLimit = 45;  ///< s, one try of up to three
};

/// A triangle side on a B-Rep edge, smooth edges and seams included.
struct EdgeSide {
  Index triangle = kNone;
  Index side = 0;  ///< corner `side` to the next
  Index edge = kNone;
  double first = 0;  ///< curve parameter at corner `side`
  double last = 0;   ///< curve parameter at the next corner
};

/// mesh.faceOf, edgeOf, vertexOf index into features (smooth edges and vertices on no sharp edge
/// carry no label). Nodes on B-Rep edges are shared by the faces of the edge: closed input, closed
/// mesh. uv: per triangle corner, the parameters on its face.
struct Tessellation {
  TriMesh mesh;
  FeatureTable features;
  std::vector<std::array<Eigen::Vector2d, 3>> uv;  ///< one triple per triangle
  std::vector<EdgeSide> edgeSides;                 ///< by triangle, then side
  double measuredDeflection = 0;  ///< mm, sampled at triangle centres and side middles
  int untessellatedFaces = 0;     ///< faces OpenCASCADE gives no triangles for
  int filledHoles = 0;            ///< holes closed by patches of least area
};

/// Runs under a guard (time, signals); a body that takes too long or crashes OpenCASCADE is tried
/// again at 8 and 64 times the deflection, which measuredDeflection then shows. Fails with Failed
/// when nothing can be tessellated.
[[nodiscard]] Result<Tessellation> tessellate(const Body& body, const TessellateOptions& options);

}  // namespace phront::cad
