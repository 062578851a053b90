// Where patches cross at a small angle, strips on both sides of the crossing are within the
// tolerance of the level, and all of them are live: four pieces at one edge. Taking one away opens
// as many edges as it closes; only a group that hangs together can go.
#include "rebuild/settle.h"

#include <BRep_Tool.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "exchange/measures.h"
#include "patches/patch_tools.h"

namespace phront::cad {
namespace {

/// Of |d|: pieces this near to the level are live if the rest needs them; the check allows ten
/// times as much on one hundredth of the area, and the small ones' deviation at single points.
constexpr double kDoubt = 5e-3;
constexpr double kDoubtOfSmall = 0.03;
constexpr double kSmallArea = 0.02;  // of d squared

using Group = std::vector<std::size_t>;

class Settler {
 public:
  Settler(std::vector<JudgedFace>& faces, double distance)
      : faces_(faces), distance_(std::abs(distance)), usesOf_(faces.size()) {
    TopTools_IndexedMapOfShape edges;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      for (const TopoDS_Edge& edge : edgesOf(faces[f].face)) {
        if (!BRep_Tool::Degenerated(edge)) ++usesOf_[f][edges.Add(edge)];
      }
      mayJoin_.push_back(!faces[f].live && isDoubtful(faces[f]));
    }
    uses_.assign(static_cast<std::size_t>(edges.Extent()) + 1, 0);
    for (std::size_t f = 0; f < faces.size(); ++f)
      if (faces[f].live) count({f}, 1);
  }

  int run() {
    int turned = 0;
    for (;;) {
      std::vector<Group> singles;
      for (std::size_t f = 0; f < faces_.size(); ++f) singles.push_back({f});
      Group best = bestOf(singles);
      if (best.empty()) best = bestOf(suspectGroups());
      if (best.empty()) return turned;
      turn(best);
      turned += static_cast<int>(best.size());
    }
  }

 private:
  [[nodiscard]] bool isDoubtful(const JudgedFace& face) const {
    if (face.mixed || face.samples.empty() || face.deviation <= kDoubt * distance_) return true;
    if (face.largest > kDoubtOfSmall * distance_) return false;
    return areaOf(face.face) < kSmallArea * distance_ * distance_;
  }

  static int open(int count) { return count != 0 && count != 2 ? 1 : 0; }

  void count(const Group& group, int sense) {
    for (const std::size_t f : group)
      for (const auto& [edge, times] : usesOf_[f])
        uses_[static_cast<std::size_t>(edge)] += sense * times;
  }

  void turn(const Group& group) {
    const bool live = faces_[group.front()].live;
    count(group, live ? -1 : 1);
    for (const std::size_t f : group) {
      faces_[f].live = !live;
      mayJoin_[f] = live;
    }
  }

  /// Change of the number of open edges when the group, all live or all dead, is turned; 0 where it
  /// must not be.
  [[nodiscard]] int gainOf(const Group& group) const {
    const bool live = faces_[group.front()].live;
    std::map<int, int> times;
    for (const std::size_t f : group) {
      if (!live && !mayJoin_[f]) return 0;
      for (const auto& [edge, n] : usesOf_[f]) times[edge] += n;
    }
    int change = 0;
    bool crowded = false;
    for (const auto& [edge, n] : times) {
      const int before = uses_[static_cast<std::size_t>(edge)];
      crowded = crowded || before > 2;
      change += open(before + (live ? -n : n)) - open(before);
    }
    return live && !crowded ? 0 : change;
  }

  [[nodiscard]] double deviationOf(const Group& group) const {
    double largest = 0;
    for (const std::size_t f : group) largest = std::max(largest, faces_[f].deviation);
    return largest;
  }

  /// The group that closes most; of equal ones the nearest to the level. Empty when none does.
  [[nodiscard]] Group bestOf(const std::vector<Group>& groups) const {
    Group best;
    int bestGain = 0;
    for (const Group& group : groups) {
      const int gain = gainOf(group);
      if (gain < bestGain ||
          (gain == bestGain && gain < 0 && deviationOf(group) < deviationOf(best))) {
        best = group;
        bestGain = gain;
      }
    }
    return best;
  }

  /// Live pieces that are off the level here and there: pairs of neighbours, and all that hang
  /// together.
  [[nodiscard]] std::vector<Group> suspectGroups() const {
    std::map<int, Group> suspectsAt;
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      if (!faces_[f].live || !faces_[f].mixed) continue;
      for (const auto& [edge, n] : usesOf_[f]) suspectsAt[edge].push_back(f);
    }
    std::set<Group> groups;
    std::map<std::size_t, std::set<std::size_t>> neighbours;
    for (const auto& [edge, suspects] : suspectsAt) {
      for (std::size_t i = 0; i < suspects.size(); ++i) {
        neighbours[suspects[i]];
        for (std::size_t j = i + 1; j < suspects.size(); ++j) {
          groups.insert({suspects[i], suspects[j]});
          neighbours[suspects[i]].insert(suspects[j]);
          neighbours[suspects[j]].insert(suspects[i]);
        }
      }
    }
    std::set<std::size_t> seen;
    for (const auto& [start, near] : neighbours) {
      if (!seen.insert(start).second) continue;
      Group whole{start};
      for (std::size_t next = 0; next < whole.size(); ++next)
        for (const std::size_t f : neighbours[whole[next]])
          if (seen.insert(f).second) whole.push_back(f);
      groups.insert(whole);
    }
    return {groups.begin(), groups.end()};
  }

  std::vector<JudgedFace>& faces_;
  double distance_;
  std::vector<std::map<int, int>> usesOf_;  ///< edge, how often the face uses it
  std::vector<bool> mayJoin_;
  std::vector<int> uses_;  ///< of each edge by live faces
};

}  // namespace

int settleDoubtful(std::vector<JudgedFace>& faces, double distance) {
  return Settler(faces, distance).run();
}

}  // namespace phront::cad
