#include "rebuild/origin.h"

#include <map>

#include "rebuild/select.h"

namespace phront::cad {

Feature originOf(const TopoDS_Face& face, const TrueDistance& phi) {
  std::map<Feature, int> votes;
  for (const FaceSample& s : interiorSamples(face))
    ++votes[phi.foot(Vec3(s.point.X(), s.point.Y(), s.point.Z())).feature];
  Feature best;
  int most = 0;
  for (const auto& [feature, count] : votes) {
    if (count <= most) continue;
    most = count;
    best = feature;
  }
  return best;
}

}  // namespace phront::cad
