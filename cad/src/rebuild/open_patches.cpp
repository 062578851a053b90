// A piece that ought to have been cut shows as one that stays open, or as a dead one beside those
// that do. Pieces lie on the surface of the patch they were cut from.
#include "rebuild/open_patches.h"

#include <Geom_Surface.hxx>
#include <algorithm>
#include <set>

#include "rebuild/edge_uses.h"

namespace phront::cad {

std::vector<bool> openPatches(const std::vector<TopoDS_Face>& patches,
                              const std::vector<JudgedFace>& pieces) {
  std::vector<TopoDS_Face> faces;
  for (const JudgedFace& piece : pieces) faces.push_back(piece.face);
  const EdgeUses uses(faces);
  std::set<const Geom_Surface*> open;  // looked up only
  for (const std::vector<std::size_t>& users : uses.faces) {
    const auto live =
        std::count_if(users.begin(), users.end(), [&](std::size_t f) { return pieces[f].live; });
    if (live != 1) continue;
    for (const std::size_t f : users) open.insert(BRep_Tool::Surface(faces[f]).get());
  }
  std::vector<bool> result;
  for (const TopoDS_Face& patch : patches)
    result.push_back(open.contains(BRep_Tool::Surface(patch).get()));
  return result;
}

}  // namespace phront::cad
