// Makes the merged triangles a closed manifold wherever their sides balance.
//
// If every directed side a->b is met by as many b->a, the triangles are a cycle, and a cycle
// becomes a manifold by pairing the sides (around an edge by angle, so that each wedge of material
// stays together) and giving each fan around a point a point of its own (Gueziec, Taubin, Lazarus &
// Horn 2001, "Cutting and stitching"). Sides without partner form loops; these are triangulated
// with minimal area (Barequet & Sharir 1995). Weak spots: a loop that visits a point twice is cut
// there; large holes get flat patches, which the measured deflection shows.
#include "tessellate/close_mesh.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "tessellate/triangulate_loop.h"

namespace phront::cad {
namespace {

using Side = std::pair<Index, Index>;
constexpr int kMaxRounds = 20;  // of cutting sides that a point split cannot part

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

Side sideOf(const SoupTriangle& t, std::size_t k) { return {t.corner[k], t.corner[(k + 1) % 3]}; }

// Corners rotated so that the smallest comes first; equal keys: equal triangles.
std::array<Index, 3> rotated(const std::array<Index, 3>& c) {
  const auto least = std::min_element(c.begin(), c.end()) - c.begin();
  return {c[at(static_cast<Index>(least))], c[at(static_cast<Index>((least + 1) % 3))],
          c[at(static_cast<Index>((least + 2) % 3))]};
}

// Two triangles over the same points with opposite orientation enclose nothing.
void cancelOpposite(Soup& soup) {
  std::map<std::array<Index, 3>, std::vector<std::size_t>> open;
  std::vector<bool> dead(soup.triangles.size(), false);
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const auto& c = soup.triangles[t].corner;
    const auto opposite = open.find(rotated({c[0], c[2], c[1]}));
    if (opposite != open.end() && !opposite->second.empty()) {
      dead[t] = dead[opposite->second.back()] = true;
      opposite->second.pop_back();
    } else {
      open[rotated(c)].push_back(t);
    }
  }
  std::size_t kept = 0;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    if (!dead[t]) soup.triangles[kept++] = soup.triangles[t];
  }
  soup.triangles.resize(kept);
}

// Sides without partner, as loops. A triangle that fills the hole runs each of them backwards.
struct BorderSide {
  Index from = kNone;  // direction of the filling: against the triangle's
  Index to = kNone;
  SideLabel label;
  Index face = kNone;  // across the side
};

std::vector<BorderSide> borderSides(const Soup& soup) {
  std::map<Side, std::vector<BorderSide>> open;
  for (const SoupTriangle& t : soup.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = sideOf(t, k);
      const auto opposite = open.find({b, a});
      if (opposite != open.end()) {
        opposite->second.pop_back();
        if (opposite->second.empty()) open.erase(opposite);
      } else {
        const SideLabel& s = t.side[k];
        open[{a, b}].push_back({b, a, {s.edge, s.last, s.first}, t.face});
      }
    }
  }
  std::vector<BorderSide> result;
  for (const auto& [side, sides] : open) result.insert(result.end(), sides.begin(), sides.end());
  return result;
}

// Walks the sides into simple loops: whenever the walk returns to a point, a loop is cut off.
std::vector<std::vector<BorderSide>> simpleLoops(const std::vector<BorderSide>& sides) {
  std::multimap<Index, std::size_t> from;
  for (std::size_t i = 0; i < sides.size(); ++i) from.emplace(sides[i].from, i);
  std::vector<std::vector<BorderSide>> loops;
  while (!from.empty()) {
    std::vector<BorderSide> path;
    Index here = from.begin()->first;
    while (true) {
      const auto next = from.find(here);
      if (next == from.end()) break;
      path.push_back(sides[next->second]);
      from.erase(next);
      here = path.back().to;
      const auto start = std::find_if(path.begin(), path.end(),
                                      [&](const BorderSide& s) { return s.from == here; });
      if (start == path.end()) continue;
      loops.emplace_back(start, path.end());
      path.erase(start, path.end());
      if (path.empty()) break;
    }
  }
  return loops;
}

void fillLoop(const std::vector<BorderSide>& loop, Soup& soup, std::vector<HolePatch>& patches) {
  HolePatch patch;
  std::vector<Vec3> points;
  std::map<Side, SideLabel> labels;
  for (const BorderSide& s : loop) {
    points.push_back(soup.points[at(s.from)]);
    labels[{s.from, s.to}] = s.label;
    patch.edges.push_back(s.label.edge);
    patch.faces.push_back(s.face);
  }
  for (const std::array<Index, 3>& local : triangulateLoop(points)) {
    SoupTriangle t;
    t.patch = static_cast<Index>(patches.size());
    for (std::size_t k = 0; k < 3; ++k) t.corner[k] = loop[at(local[k])].from;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto label = labels.find(sideOf(t, k));
      if (label != labels.end()) t.side[k] = label->second;
    }
    soup.triangles.push_back(t);
  }
  patches.push_back(std::move(patch));
}

// A side of a triangle: 3 t + k.
using HalfEdge = std::size_t;
constexpr HalfEdge kNoPartner = std::numeric_limits<HalfEdge>::max();

struct AngledSide {
  HalfEdge half = 0;
  bool forward = false;
  double angle = 0;
};

// Material lies below a forward triangle (in angle about a->b), above a backward one: going down
// from a forward triangle, the first backward one bounds the same wedge. Like matching brackets.
void pairByAngle(const Soup& soup, Index a, Index b, std::vector<AngledSide> around,
                 std::vector<HalfEdge>& partner) {
  const Vec3 origin = soup.points[at(a)];
  const Vec3 axis = (soup.points[at(b)] - origin).normalized();
  const Vec3 x = axis.unitOrthogonal();
  const Vec3 y = axis.cross(x);
  for (AngledSide& s : around) {
    const SoupTriangle& t = soup.triangles[s.half / 3];
    const Vec3 r = soup.points[at(t.corner[(s.half + 2 - 3 * (s.half / 3)) % 3])] - origin;
    s.angle = std::atan2(r.dot(y), r.dot(x));
  }
  std::stable_sort(around.begin(), around.end(),
                   [](const AngledSide& p, const AngledSide& q) { return p.angle > q.angle; });
  std::vector<HalfEdge> waiting;
  for (int turn = 0; turn < 2; ++turn) {
    for (const AngledSide& s : around) {
      if (partner[s.half] != kNoPartner) continue;
      if (s.forward) {
        if (turn == 0) waiting.push_back(s.half);
      } else if (!waiting.empty()) {
        partner[s.half] = waiting.back();
        partner[waiting.back()] = s.half;
        waiting.pop_back();
      }
    }
  }
}

struct Pairing {
  std::vector<HalfEdge> partner;
  std::map<Side, std::vector<HalfEdge>> crowded;  // forward halves of sides with several pairs
};

Pairing pairSides(const Soup& soup) {
  struct Entry {
    Side side;
    HalfEdge half;
    bool forward;
  };
  std::vector<Entry> entries;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = sideOf(soup.triangles[t], k);
      entries.push_back({{std::min(a, b), std::max(a, b)}, 3 * t + k, a < b});
    }
  }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& p, const Entry& q) { return p.side < q.side; });
  Pairing pairing;
  pairing.partner.assign(3 * soup.triangles.size(), kNoPartner);
  for (std::size_t i = 0; i < entries.size();) {
    std::size_t end = i;
    std::vector<AngledSide> around;
    while (end < entries.size() && entries[end].side == entries[i].side) {
      around.push_back({entries[end].half, entries[end].forward, 0});
      ++end;
    }
    if (around.size() == 2 && around[0].forward != around[1].forward) {
      pairing.partner[around[0].half] = around[1].half;
      pairing.partner[around[1].half] = around[0].half;
    } else if (around.size() > 2) {
      pairByAngle(soup, entries[i].side.first, entries[i].side.second, around, pairing.partner);
      for (const AngledSide& s : around) {
        if (s.forward && pairing.partner[s.half] != kNoPartner) {
          pairing.crowded[entries[i].side].push_back(s.half);
        }
      }
    }
    i = end;
  }
  return pairing;
}

// Each fan of triangles around a point gets a point of its own.
void splitFans(Soup& soup, const std::vector<HalfEdge>& partner) {
  std::vector<HalfEdge> parent(partner.size());
  std::iota(parent.begin(), parent.end(), HalfEdge{0});
  const auto find = [&](HalfEdge i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const auto unite = [&](HalfEdge i, HalfEdge j) {
    i = find(i);
    j = find(j);
    if (i != j) parent[std::max(i, j)] = std::min(i, j);
  };
  const auto next = [](HalfEdge h) { return h % 3 == 2 ? h - 2 : h + 1; };
  for (HalfEdge h = 0; h < partner.size(); ++h) {
    if (partner[h] == kNoPartner) continue;
    unite(h, next(partner[h]));
    unite(next(h), partner[h]);
  }
  std::vector<HalfEdge> owner(soup.points.size(), kNoPartner);
  std::vector<Index> pointOfFan(partner.size(), kNone);
  for (HalfEdge h = 0; h < partner.size(); ++h) {
    const HalfEdge fan = find(h);
    Index& corner = soup.triangles[h / 3].corner[h % 3];
    if (pointOfFan[fan] == kNone) {
      HalfEdge& first = owner[at(corner)];
      if (first == kNoPartner) {
        first = fan;
        pointOfFan[fan] = corner;
      } else {
        pointOfFan[fan] = static_cast<Index>(soup.points.size());
        soup.points.push_back(Vec3(soup.points[at(corner)]));
        soup.vertexOf.push_back(soup.vertexOf[at(corner)]);
        owner.push_back(fan);
      }
    }
    corner = pointOfFan[fan];
  }
}

// Puts a point `middle` on side k of a triangle; returns the second half.
SoupTriangle cutSide(SoupTriangle& t, std::size_t k, Index middle) {
  const std::size_t k1 = (k + 1) % 3;
  const Eigen::Vector2d uv = 0.5 * (t.uv[k] + t.uv[k1]);
  const double parameter = 0.5 * (t.side[k].first + t.side[k].last);
  SoupTriangle second = t;
  second.corner[k] = middle;
  second.uv[k] = uv;
  second.side[k].first = parameter;
  second.side[(k + 2) % 3] = {};
  t.corner[k1] = middle;
  t.uv[k1] = uv;
  t.side[k].last = parameter;
  t.side[k1] = {};
  return second;
}

// A side that two fans share at both ends: all pairs but one get a point in the middle.
// Returns false when there is none.
bool cutCrowdedSides(Soup& soup, const Pairing& pairing) {
  std::vector<bool> touched(soup.triangles.size(), false);
  bool found = false;
  for (const auto& [side, halves] : pairing.crowded) {
    for (std::size_t i = 1; i < halves.size(); ++i) {
      const HalfEdge h = halves[i];
      const HalfEdge p = pairing.partner[h];
      const Side now = sideOf(soup.triangles[h / 3], h % 3);
      bool shared = false;
      for (std::size_t j = 0; j < i; ++j) {
        shared |= sideOf(soup.triangles[halves[j] / 3], halves[j] % 3) == now;
      }
      if (!shared) continue;
      found = true;
      if (touched[h / 3] || touched[p / 3]) continue;
      touched[h / 3] = touched[p / 3] = true;
      const Index middle = static_cast<Index>(soup.points.size());
      soup.points.push_back(0.5 * (soup.points[at(now.first)] + soup.points[at(now.second)]));
      soup.vertexOf.push_back(kNone);
      soup.triangles.push_back(cutSide(soup.triangles[h / 3], h % 3, middle));
      soup.triangles.push_back(cutSide(soup.triangles[p / 3], p % 3, middle));
    }
  }
  return found;
}

void dropUnusedPoints(Soup& soup) {
  std::vector<Index> renumbered(soup.points.size(), kNone);
  for (const SoupTriangle& t : soup.triangles) {
    for (const Index c : t.corner) renumbered[at(c)] = 0;
  }
  Index count = 0;
  for (std::size_t i = 0; i < renumbered.size(); ++i) {
    if (renumbered[i] == kNone) continue;
    soup.points[at(count)] = soup.points[i];
    soup.vertexOf[at(count)] = soup.vertexOf[i];
    renumbered[i] = count++;
  }
  soup.points.resize(at(count));
  soup.vertexOf.resize(at(count));
  for (SoupTriangle& t : soup.triangles) {
    for (Index& c : t.corner) c = renumbered[at(c)];
  }
}

}  // namespace

std::vector<HolePatch> closeMesh(Soup& soup, const std::vector<bool>& mustClose) {
  cancelOpposite(soup);
  std::vector<HolePatch> patches;
  for (const std::vector<BorderSide>& loop : simpleLoops(borderSides(soup))) {
    const bool fill = std::all_of(loop.begin(), loop.end(), [&](const BorderSide& s) {
      return s.label.edge == kNone || mustClose[at(s.label.edge)];
    });
    if (fill) fillLoop(loop, soup, patches);
  }
  if (!patches.empty()) cancelOpposite(soup);  // a lone triangle and its lid
  for (int round = 0; round < kMaxRounds; ++round) {
    const Pairing pairing = pairSides(soup);
    splitFans(soup, pairing.partner);
    if (!cutCrowdedSides(soup, pairing)) break;
  }
  dropUnusedPoints(soup);
  return patches;
}

}  // namespace phront::cad
