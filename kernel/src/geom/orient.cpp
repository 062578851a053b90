// Makes neighbouring triangles agree about their outside. Walks over the edges of two triangles
// breadth first and notes for each triangle whether it is turned against the first of its part; in
// each part the orientation that covers more area stays. Weak spots: parts are taken as they come,
// so one that is inside out altogether stays so (it may bound a cavity); one-sided surfaces have no
// answer and keep a seam where neighbours disagree.
#include <cstdint>
#include <utility>
#include <vector>

#include "geom/mesh_topology.h"
#include "phront/tri_mesh.h"

namespace phront {

namespace {

double areaOf(const TriMesh& mesh, Index triangle) {
  const auto& corner = mesh.triangles[static_cast<std::size_t>(triangle)];
  const Vec3& a = mesh.points[static_cast<std::size_t>(corner[0])];
  const Vec3& b = mesh.points[static_cast<std::size_t>(corner[1])];
  const Vec3& c = mesh.points[static_cast<std::size_t>(corner[2])];
  return (b - a).cross(c - a).norm() / 2;
}

class Orienter {
 public:
  explicit Orienter(const TriMesh& mesh)
      : mesh_(mesh), across_(3 * mesh.triangles.size(), kNone), turns_(mesh.triangles.size()) {
    const MeshEdges edges = meshEdges(mesh);
    for (const MeshEdge& edge : edges.edges) {
      const auto sides = edges.sidesOf(edge);
      if (sides.size() != 2) continue;
      across_[static_cast<std::size_t>(sides[0])] = sides[1];
      across_[static_cast<std::size_t>(sides[1])] = sides[0];
    }
  }

  /// The triangles to turn.
  std::vector<Index> run() {
    std::vector<Index> wrong;
    for (Index first = 0; first < static_cast<Index>(turns_.size()); ++first) {
      if (turnOf(first) != Turn::Unknown) continue;
      const std::vector<Index> part = partOf(first);
      double with = 0;
      double against = 0;
      for (const Index t : part) (turnOf(t) == Turn::With ? with : against) += areaOf(mesh_, t);
      const Turn fewer = against > with ? Turn::With : Turn::Against;
      for (const Index t : part) {
        if (turnOf(t) == fewer) wrong.push_back(t);
      }
    }
    return wrong;
  }

 private:
  enum class Turn : std::uint8_t { Unknown, With, Against };  // the first triangle of the part

  Turn& turnOf(Index triangle) { return turns_[static_cast<std::size_t>(triangle)]; }

  std::vector<Index> partOf(Index first) {
    turnOf(first) = Turn::With;
    std::vector<Index> part{first};
    for (std::size_t i = 0; i < part.size(); ++i) {
      const Turn own = turnOf(part[i]);
      for (Index side = 3 * part[i]; side < 3 * part[i] + 3; ++side) {
        const Index other = across_[static_cast<std::size_t>(side)];
        if (other == kNone || turnOf(other / 3) != Turn::Unknown) continue;
        const bool agree = sideStart(mesh_, side) != sideStart(mesh_, other);
        turnOf(other / 3) = agree == (own == Turn::With) ? Turn::With : Turn::Against;
        part.push_back(other / 3);
      }
    }
    return part;
  }

  const TriMesh& mesh_;
  std::vector<Index> across_;  // per side: the only other side on its edge
  std::vector<Turn> turns_;    // per triangle
};

}  // namespace

OrientedMesh orient(TriMesh mesh) {
  const std::vector<Index> wrong = Orienter(mesh).run();
  for (const Index triangle : wrong) {
    const auto t = static_cast<std::size_t>(triangle);
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    // Sides (0-1, 1-2, 2-0) become (0-2, 2-1, 1-0).
    if (!mesh.edgeOf.empty()) std::swap(mesh.edgeOf[3 * t], mesh.edgeOf[3 * t + 2]);
  }
  return {std::move(mesh), static_cast<Index>(wrong.size())};
}

}  // namespace phront
