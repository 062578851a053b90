// Descent over the neighbourhood of the foot: across the side it lies on, around the corner it lies
// on; the interior of a triangle is a minimum by itself. Every step lowers the distance, so it
// ends. Weak spot: corners of very many triangles cost their whole ring.
#include "front/local_foot.h"

namespace phront {

namespace {

// Far more steps than a walk within a cell's reach needs; a guard, not a tuning value.
constexpr int kMaxSteps = 1000;
// A step must gain more than round-off, else neighbours that share the foot would alternate.
constexpr double kGain = 1 - 1e-14;

}  // namespace

LocalFoot::LocalFoot(const SurfaceDistance& surface)
    : surface_(surface), rings_(pointRings(surface.mesh())) {
  const TriMesh& mesh = surface.mesh();
  across_.assign(3 * mesh.triangles.size(), kNone);
  const MeshEdges edges = meshEdges(mesh);
  for (const MeshEdge& edge : edges.edges) {
    const auto sides = edges.sidesOf(edge);
    if (sides.size() != 2) continue;
    across_[static_cast<std::size_t>(sides[0])] = sides[1] / 3;
    across_[static_cast<std::size_t>(sides[1])] = sides[0] / 3;
  }
}

FootPoint LocalFoot::find(const Vec3& x, Index triangle) const {
  FootPoint best = surface_.footOnTriangle(x, triangle);
  for (int step = 0; step < kMaxSteps; ++step) {
    const FootPoint here = best;
    if (here.kind == FeatureKind::Edge) {
      const Index next = across_[static_cast<std::size_t>(3 * here.triangle + here.corner)];
      if (next == kNone) return best;
      const FootPoint there = surface_.footOnTriangle(x, next);
      if (there.distance < kGain * best.distance) best = there;
    } else if (here.kind == FeatureKind::Vertex) {
      const auto& corners = surface_.mesh().triangles[static_cast<std::size_t>(here.triangle)];
      for (const Index t : rings_.of(corners[static_cast<std::size_t>(here.corner)])) {
        const FootPoint there = surface_.footOnTriangle(x, t);
        if (there.distance < kGain * best.distance) best = there;
      }
    }
    if (best.triangle == here.triangle) return best;
  }
  return best;
}

}  // namespace phront
