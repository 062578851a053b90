// Exact signed distance to a triangle mesh: the reference for every field, front and check.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>

#include "phront/status.h"
#include "phront/tri_mesh.h"
#include "phront/types.h"

namespace phront {

/// Closest point of a surface to a query point x.
struct FootPoint {
  Vec3 point = Vec3::Zero();                                  ///< cp(x), on the surface
  double distance = std::numeric_limits<double>::infinity();  ///< |x - cp(x)| >= 0
  double sign = 1;         ///< -1 inside material, +1 outside; open shells: side of the face
  Index triangle = kNone;  ///< triangle that holds the foot; kNone when nothing was in reach
  Vec3 barycentric = Vec3::Zero();       ///< of the foot in that triangle
  FeatureKind kind = FeatureKind::Face;  ///< where in the triangle the foot lies
  Index corner = 0;           ///< kind Edge: side (corner k to k+1); kind Vertex: corner; else 0
  bool beyondBorder = false;  ///< foot on a free edge of an open shell: phi has no sign here

  [[nodiscard]] double phi() const { return sign * distance; }
};

/// phi at 8 x 8 x 8 nodes of a grid: node (i,j,k) of the block is number (k * 8 + j) * 8 + i.
struct BlockPhi {
  std::array<std::uint64_t, 8> held{};  ///< bit j * 8 + i of word k: the node is within reach
  std::array<double, 512> phi{};        ///< of held nodes
  std::array<Index, 512> triangle{};    ///< of held nodes: closest; kNone: beyond the border
};

/// How the sign is found.
enum class SignRule {
  Topology,  ///< of the foot's pseudonormal: the mesh bounds one material
  Union,     ///< connected parts that touch or overlap: inside is where any of them is; a query
             ///< more for every other part whose box holds the point
  Unsigned,  ///< always +1, and no free edge is a border: fronts wrap an open mesh on both sides
};

/// Exact signed distance to a mesh by a bounding-volume hierarchy (closest point) and
/// angle-weighted pseudonormals (sign; Baerentzen & Aanaes 2005). Immutable once built; queries are
/// thread safe and allocate nothing. phi < 0 inside material.
class SurfaceDistance {
 public:
  /// Fails with InvalidArgument on an empty mesh, points that are NaN, infinite or beyond 1e150,
  /// indices out of range, and closed meshes with a triangle turned against its neighbour: they
  /// have no inside (orient() mends them). Degenerate triangles are accepted (they count as
  /// segments or points), duplicate ones too; a triangle and its reverse make a hole.
  /// `gap` (model units): where every free edge faces another one within it, the surface counts as
  /// closed; the winding number tells the sign beside the gaps, and phi jumps by up to their width
  /// across them. 0: free edges are borders.
  [[nodiscard]] static Result<SurfaceDistance> build(TriMesh mesh,
                                                     SignRule rule = SignRule::Topology,
                                                     double gap = 0);

  [[nodiscard]] const TriMesh& mesh() const;
  [[nodiscard]] const Box3& box() const;
  [[nodiscard]] bool closed() const;      ///< no free edges, or gaps only; or Unsigned
  [[nodiscard]] bool watertight() const;  ///< no free edges

  /// Closest point of the whole surface. `reach` bounds the search: beyond it triangle == kNone.
  [[nodiscard]] FootPoint foot(const Vec3& x,
                               double reach = std::numeric_limits<double>::infinity()) const;

  /// Closest point of the triangles with the given B-Rep face only (no sign: always +1).
  [[nodiscard]] FootPoint footOnFace(const Vec3& x, Index face,
                                     double reach = std::numeric_limits<double>::infinity()) const;

  /// foot() that starts from a triangle thought to be near the answer: same result, whatever the
  /// triangle. Measured to cost about as much as foot().
  [[nodiscard]] FootPoint footFrom(const Vec3& x, Index triangle) const;

  /// foot() at the nodes origin + spacing (first + (i,j,k)), i, j, k = 0 .. 7, that are not farther
  /// than `reach`: the same bits, several times sooner. spacing > 0. `start`, a triangle thought to
  /// be near the middle of the block, spares a search; the result is the same, whatever it is.
  [[nodiscard]] BlockPhi phiOnBlock(const Vec3& origin, double spacing,
                                    const std::array<std::int32_t, 3>& first, double reach,
                                    Index start = kNone) const;

  /// Closest point of one triangle (no sign: always +1).
  [[nodiscard]] FootPoint footOnTriangle(const Vec3& x, Index triangle) const;

  [[nodiscard]] double signedDistance(const Vec3& x) const { return foot(x).phi(); }

  /// The feature that holds a foot: labelled vertex, labelled edge, else the face of the triangle.
  [[nodiscard]] Feature featureOf(const FootPoint& foot) const;

  /// Unit gradient of phi at x from its foot; the pseudonormal at the foot when x lies on it.
  [[nodiscard]] Vec3 gradient(const Vec3& x, const FootPoint& foot) const;

  /// Times the surface winds around x: 1 inside a closed outward-oriented mesh, 0 outside;
  /// fractional near open borders (Jacobson et al. 2013, with a far-field expansion
  /// after Barill et al. 2018).
  [[nodiscard]] double windingNumber(const Vec3& x) const;
  /// The winding number of a closed mesh, a whole number: sooner.
  [[nodiscard]] int timesAround(const Vec3& x) const;

  SurfaceDistance(SurfaceDistance&&) noexcept;
  SurfaceDistance& operator=(SurfaceDistance&&) noexcept;
  ~SurfaceDistance();

 private:
  struct Impl;
  struct BlockVisitor;
  explicit SurfaceDistance(std::unique_ptr<const Impl> impl);
  std::unique_ptr<const Impl> impl_;
};

}  // namespace phront
