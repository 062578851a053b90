// Which pieces use which edge.
#pragma once

#include <BRep_Tool.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <vector>

#include "patches/patch_tools.h"

namespace phront::cad {

/// Edges (degenerated ones aside) with the faces that use them, a face as often as it does.
struct EdgeUses {
  TopTools_IndexedMapOfShape edges;
  std::vector<std::vector<std::size_t>> faces;

  explicit EdgeUses(const std::vector<TopoDS_Face>& pieces) {
    for (std::size_t f = 0; f < pieces.size(); ++f) {
      for (const TopoDS_Edge& edge : edgesOf(pieces[f])) {
        if (BRep_Tool::Degenerated(edge)) continue;
        const auto index = static_cast<std::size_t>(edges.Add(edge));
        if (faces.size() < index) faces.emplace_back();
        faces[index - 1].push_back(f);
      }
    }
  }
  [[nodiscard]] const TopoDS_Edge& edge(std::size_t i) const {
    return TopoDS::Edge(edges(static_cast<int>(i) + 1));
  }
};

}  // namespace phront::cad
