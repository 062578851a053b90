// One node per place: union-find over the nodes of all faces.
//
// Identity comes from topology (k-th point of the same edge, end of an edge at the same vertex),
// not from coordinates, so that thin walls and slivers stay apart and loose tolerances do no harm.
#include <map>
#include <numeric>

#include "tessellate/soup.h"

namespace phront::cad {
namespace {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// The smaller index represents the set: independent of the order of unions.
  void unite(std::size_t a, std::size_t b) {
    a = find(a);
    b = find(b);
    if (a == b) return;
    if (a < b) {
      parent_[b] = a;
    } else {
      parent_[a] = b;
    }
  }

 private:
  std::vector<std::size_t> parent_;
};

struct PolygonUse {
  const FaceMesh* face = nullptr;
  const EdgePolygon* polygon = nullptr;
  std::size_t offset = 0;  // of the face's nodes in the numbering of all nodes
};

// Nodes of `b` to nodes of `a` in order along the curve, by distance.
void uniteByPosition(const PolygonUse& a, const PolygonUse& b, double tolerance,
                     DisjointSets& sets) {
  std::size_t from = 0;
  for (const Index nb : b.polygon->nodes) {
    const Vec3& p = b.face->nodes[static_cast<std::size_t>(nb)];
    double best = tolerance;
    std::size_t match = a.polygon->nodes.size();
    for (std::size_t k = from; k < a.polygon->nodes.size(); ++k) {
      const Vec3& q = a.face->nodes[static_cast<std::size_t>(a.polygon->nodes[k])];
      const double distance = (p - q).norm();
      if (distance > best) continue;
      best = distance;
      match = k;
    }
    if (match == a.polygon->nodes.size()) continue;
    sets.unite(a.offset + static_cast<std::size_t>(a.polygon->nodes[match]),
               b.offset + static_cast<std::size_t>(nb));
    from = match + 1;
  }
}

void uniteUses(const std::vector<PolygonUse>& uses, double tolerance, DisjointSets& sets) {
  // The finest use leads.
  const PolygonUse* lead = &uses.front();
  for (const PolygonUse& use : uses) {
    if (use.polygon->nodes.size() > lead->polygon->nodes.size()) lead = &use;
  }
  for (const PolygonUse& use : uses) {
    if (&use == lead) continue;
    if (use.polygon->nodes.size() != lead->polygon->nodes.size()) {
      uniteByPosition(*lead, use, tolerance, sets);
      continue;
    }
    for (std::size_t k = 0; k < use.polygon->nodes.size(); ++k) {
      sets.unite(lead->offset + static_cast<std::size_t>(lead->polygon->nodes[k]),
                 use.offset + static_cast<std::size_t>(use.polygon->nodes[k]));
    }
  }
}

// Ends of edges meet in vertices; `vertexNode[v]` is some node at vertex v.
void uniteVertices(const std::vector<std::vector<PolygonUse>>& usesOfEdge,
                   std::vector<std::size_t>& vertexNode, DisjointSets& sets) {
  constexpr std::size_t kNoNode = std::numeric_limits<std::size_t>::max();
  const auto join = [&](Index vertex, std::size_t node) {
    if (vertex == kNone) return;
    std::size_t& known = vertexNode[static_cast<std::size_t>(vertex)];
    if (known == kNoNode) {
      known = node;
    } else {
      sets.unite(known, node);
    }
  };
  for (const auto& uses : usesOfEdge) {
    for (const PolygonUse& use : uses) {
      const EdgePolygon& p = *use.polygon;
      if (p.nodes.empty()) continue;
      join(p.firstVertex, use.offset + static_cast<std::size_t>(p.nodes.front()));
      join(p.lastVertex, use.offset + static_cast<std::size_t>(p.nodes.back()));
      if (!p.degenerated) continue;
      for (const Index node : p.nodes) {
        sets.unite(use.offset + static_cast<std::size_t>(p.nodes.front()),
                   use.offset + static_cast<std::size_t>(node));
      }
    }
  }
}

using SideMap = std::map<std::pair<Index, Index>, SideLabel>;

SideMap sidesOf(const FaceMesh& face) {
  SideMap sides;
  for (const EdgePolygon& p : face.polygons) {
    if (p.degenerated) continue;
    for (std::size_t k = 0; k + 1 < p.nodes.size(); ++k) {
      const double t0 = p.parameters[k];
      const double t1 = p.parameters[k + 1];
      sides[{p.nodes[k], p.nodes[k + 1]}] = {p.edge, t0, t1};
      sides[{p.nodes[k + 1], p.nodes[k]}] = {p.edge, t1, t0};
    }
  }
  return sides;
}

}  // namespace

Soup mergeNodes(const ShapeMesh& mesh, const std::vector<double>& edgeTolerance,
                Index vertexCount) {
  std::size_t nodeCount = 0;
  std::vector<std::size_t> offsets;
  std::vector<std::vector<PolygonUse>> usesOfEdge(edgeTolerance.size());
  for (const FaceMesh& face : mesh.faces) {
    offsets.push_back(nodeCount);
    for (const EdgePolygon& p : face.polygons) {
      usesOfEdge[static_cast<std::size_t>(p.edge)].push_back({&face, &p, nodeCount});
    }
    nodeCount += face.nodes.size();
  }
  DisjointSets sets(nodeCount);
  for (std::size_t e = 0; e < usesOfEdge.size(); ++e) {
    if (!usesOfEdge[e].empty()) uniteUses(usesOfEdge[e], edgeTolerance[e], sets);
  }
  std::vector<std::size_t> vertexNode(static_cast<std::size_t>(vertexCount),
                                      std::numeric_limits<std::size_t>::max());
  uniteVertices(usesOfEdge, vertexNode, sets);

  Soup soup;
  std::vector<Index> pointOf(nodeCount, kNone);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const FaceMesh& face = mesh.faces[f];
    for (std::size_t n = 0; n < face.nodes.size(); ++n) {
      const std::size_t root = sets.find(offsets[f] + n);
      if (pointOf[root] == kNone) {
        pointOf[root] = static_cast<Index>(soup.points.size());
        soup.points.push_back(face.nodes[n]);
      }
      pointOf[offsets[f] + n] = pointOf[root];
    }
  }
  soup.vertexOf.assign(soup.points.size(), kNone);
  for (std::size_t v = 0; v < vertexNode.size(); ++v) {
    if (vertexNode[v] >= nodeCount) continue;
    Index& label = soup.vertexOf[static_cast<std::size_t>(pointOf[vertexNode[v]])];
    if (label == kNone) label = static_cast<Index>(v);
  }
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const FaceMesh& face = mesh.faces[f];
    const SideMap sides = sidesOf(face);
    for (const std::array<Index, 3>& local : face.triangles) {
      SoupTriangle t;
      t.face = face.face;
      for (std::size_t k = 0; k < 3; ++k) {
        t.corner[k] = pointOf[offsets[f] + static_cast<std::size_t>(local[k])];
        t.uv[k] = face.uv[static_cast<std::size_t>(local[k])];
        const auto side = sides.find({local[k], local[(k + 1) % 3]});
        if (side != sides.end()) t.side[k] = side->second;
      }
      if (t.corner[0] == t.corner[1] || t.corner[1] == t.corner[2] || t.corner[2] == t.corner[0]) {
        continue;
      }
      soup.triangles.push_back(t);
    }
  }
  return soup;
}

}  // namespace phront::cad
