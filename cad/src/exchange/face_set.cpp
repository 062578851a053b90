// The faces of a manifold shell agree when each edge is run through once forwards and once
// backwards. Agreement is a two-colouring of the graph of faces, found by breadth-first search; of
// the two colourings of a component the one that turns fewer faces is taken (volume decides inside
// and outside later). ShapeFix_Shell does the like but reorders faces and splits shells.
#include "exchange/face_set.h"

#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <algorithm>
#include <numeric>
#include <utility>

namespace phront::cad {
namespace {

struct Use {
  std::size_t face = 0;
  bool forward = true;
};

// Uses of every edge, by edge.
struct EdgeTable {
  TopTools_IndexedMapOfShape edges;
  std::vector<std::vector<Use>> uses;

  explicit EdgeTable(const FaceSet& faces) {
    for (std::size_t f = 0; f < faces.size(); ++f) {
      for (TopExp_Explorer it(faces[f], TopAbs_EDGE); it.More(); it.Next()) {
        const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
        const TopAbs_Orientation way = edge.Orientation();
        if (way != TopAbs_FORWARD && way != TopAbs_REVERSED) continue;
        if (BRep_Tool::Degenerated(edge)) continue;
        const auto index = static_cast<std::size_t>(edges.Add(edge)) - 1;
        if (index == uses.size()) uses.emplace_back();
        uses[index].push_back({f, way == TopAbs_FORWARD});
      }
    }
  }
};

std::vector<std::vector<std::size_t>> edgesByFace(const EdgeTable& table, std::size_t faceCount) {
  std::vector<std::vector<std::size_t>> byFace(faceCount);
  for (std::size_t e = 0; e < table.uses.size(); ++e) {
    for (const Use& use : table.uses[e]) byFace[use.face].push_back(e);
  }
  for (auto& edges : byFace) std::sort(edges.begin(), edges.end());
  return byFace;
}

struct Neighbour {
  std::size_t face = 0;
  bool agrees = true;
};

std::vector<std::vector<Neighbour>> neighbours(const EdgeTable& table, std::size_t faceCount) {
  std::vector<std::vector<Neighbour>> result(faceCount);
  for (const auto& uses : table.uses) {
    if (uses.size() != 2 || uses[0].face == uses[1].face) continue;
    const bool agrees = uses[0].forward != uses[1].forward;
    result[uses[0].face].push_back({uses[1].face, agrees});
    result[uses[1].face].push_back({uses[0].face, agrees});
  }
  return result;
}

}  // namespace

FaceSet facesOf(const TopoDS_Shape& shape) {
  FaceSet faces;
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    faces.push_back(TopoDS::Face(it.Current()));
  }
  return faces;
}

EdgeUse edgeUse(const FaceSet& faces) {
  const EdgeTable table(faces);
  EdgeUse use;
  use.edges = static_cast<int>(table.uses.size());
  for (const auto& uses : table.uses) {
    if (uses.size() == 1) ++use.freeEdges;
    if (uses.size() > 2) ++use.overusedEdges;
    if (uses.size() == 2 && uses[0].forward == uses[1].forward) ++use.clashingEdges;
  }
  return use;
}

int dropDuplicates(FaceSet& faces) {
  const EdgeTable table(faces);
  const auto edges = edgesByFace(table, faces.size());
  FaceSet kept;
  std::vector<std::size_t> keptIndex;
  TopTools_IndexedMapOfShape seen;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const int before = seen.Extent();
    if (seen.Add(faces[f]) <= before) continue;
    const bool crowded =
        !edges[f].empty() && std::all_of(edges[f].begin(), edges[f].end(),
                                         [&](std::size_t e) { return table.uses[e].size() > 2; });
    const bool twin = crowded && std::any_of(keptIndex.begin(), keptIndex.end(),
                                             [&](std::size_t k) { return edges[k] == edges[f]; });
    if (twin) continue;
    kept.push_back(faces[f]);
    keptIndex.push_back(f);
  }
  const int dropped = static_cast<int>(faces.size() - kept.size());
  faces = std::move(kept);
  return dropped;
}

int orientAlike(FaceSet& faces) {
  const auto graph = neighbours(EdgeTable(faces), faces.size());
  enum : char { kUnseen, kKeep, kTurn };
  std::vector<char> state(faces.size(), kUnseen);
  for (std::size_t root = 0; root < faces.size(); ++root) {
    if (state[root] != kUnseen) continue;
    std::vector<std::size_t> component{root};
    state[root] = kKeep;
    for (std::size_t next = 0; next < component.size(); ++next) {
      const std::size_t face = component[next];
      for (const Neighbour& neighbour : graph[face]) {
        const bool turn = (state[face] == kTurn) == neighbour.agrees;
        const char wanted = turn ? kTurn : kKeep;
        if (state[neighbour.face] == kUnseen) {
          state[neighbour.face] = wanted;
          component.push_back(neighbour.face);
        } else if (state[neighbour.face] != wanted) {
          return -1;
        }
      }
    }
    const auto turned = std::count_if(component.begin(), component.end(),
                                      [&](std::size_t f) { return state[f] == kTurn; });
    if (2 * static_cast<std::size_t>(turned) > component.size()) {
      for (const std::size_t f : component) state[f] = state[f] == kTurn ? kKeep : kTurn;
    }
  }
  int turned = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (state[f] != kTurn) continue;
    faces[f].Reverse();
    ++turned;
  }
  return turned;
}

std::vector<FaceSet> componentsOf(const FaceSet& faces) {
  const EdgeTable table(faces);
  const auto edges = edgesByFace(table, faces.size());
  std::vector<bool> seen(faces.size(), false);
  std::vector<FaceSet> components;
  for (std::size_t root = 0; root < faces.size(); ++root) {
    if (seen[root]) continue;
    std::vector<std::size_t> component{root};
    seen[root] = true;
    for (std::size_t next = 0; next < component.size(); ++next) {
      for (const std::size_t e : edges[component[next]]) {
        for (const Use& use : table.uses[e]) {
          if (seen[use.face]) continue;
          seen[use.face] = true;
          component.push_back(use.face);
        }
      }
    }
    std::sort(component.begin(), component.end());
    FaceSet set;
    for (const std::size_t f : component) set.push_back(faces[f]);
    components.push_back(std::move(set));
  }
  return components;
}

TopoDS_Shell shellOf(const FaceSet& faces) {
  BRep_Builder builder;
  TopoDS_Shell shell;
  builder.MakeShell(shell);
  for (const TopoDS_Face& face : faces) builder.Add(shell, face);
  shell.Closed(BRep_Tool::IsClosed(shell));
  return shell;
}

}  // namespace phront::cad
