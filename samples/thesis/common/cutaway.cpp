// A triangle and its image on the next surface span a prism; cut in three tetrahedra, its section
// is a few triangles. Diagonals go up from the point with the smaller number, so that neighbours
// agree and the section has no cracks.
#include "common/cutaway.h"

#include <algorithm>
#include <map>
#include <utility>

namespace thesis {
namespace {

using phront::Index;
using phront::TriMesh;
using phront::Vec3;

class Cutter {
 public:
  Cutter(const std::vector<std::vector<Vec3>>& surfaces, const Vec3& onPlane, const Vec3& normal)
      : surfaces_(surfaces),
        perSurface_(static_cast<Index>(surfaces.front().size())),
        onPlane_(onPlane),
        normal_(normal) {}

  /// Numbers of points run through all surfaces.
  [[nodiscard]] Index number(std::size_t surface, Index point) const {
    return static_cast<Index>(surface) * perSurface_ + point;
  }

  void addTriangle(const std::array<Index, 3>& t, Index label) {
    std::vector<Index> kept;
    for (std::size_t k = 0; k < 3; ++k) {
      const Index next = t[(k + 1) % 3];
      if (!near(t[k])) kept.push_back(whole(t[k]));
      if (near(t[k]) != near(next)) kept.push_back(cut(t[k], next));
    }
    for (std::size_t k = 2; k < kept.size(); ++k) add({kept[0], kept[k - 1], kept[k]}, label);
  }

  void addSection(const std::array<Index, 4>& tetrahedron, Index label) {
    std::vector<Index> front;
    std::vector<Index> behind;
    for (const Index p : tetrahedron) (near(p) ? front : behind).push_back(p);
    if (front.empty() || behind.empty()) return;
    if (front.size() == 2) {
      const std::array<Index, 4> q{cut(front[0], behind[0]), cut(front[0], behind[1]),
                                   cut(front[1], behind[1]), cut(front[1], behind[0])};
      addFacing({q[0], q[1], q[2]}, label);
      addFacing({q[0], q[2], q[3]}, label);
      return;
    }
    std::array<Index, 3> t{};
    std::size_t k = 0;
    for (const Index p : front) {
      for (const Index q : behind) t[k++] = cut(p, q);
    }
    addFacing(t, label);
  }

  TriMesh mesh;

 private:
  [[nodiscard]] const Vec3& at(Index number) const {
    return surfaces_[static_cast<std::size_t>(number / perSurface_)]
                    [static_cast<std::size_t>(number % perSurface_)];
  }
  [[nodiscard]] double height(Index number) const { return normal_.dot(at(number) - onPlane_); }
  [[nodiscard]] bool near(Index number) const { return height(number) > 0; }

  Index whole(Index p) { return point({p, p}, at(p)); }
  Index cut(Index p, Index q) {
    if (p > q) std::swap(p, q);  // the same bits from both sides
    const double share = height(p) / (height(p) - height(q));
    return point({p, q}, at(p) + share * (at(q) - at(p)));
  }
  Index point(const std::pair<Index, Index>& key, const Vec3& x) {
    const auto [entry, isNew] = numbers_.try_emplace(key, static_cast<Index>(mesh.points.size()));
    if (isNew) mesh.points.push_back(x);
    return entry->second;
  }

  void add(const std::array<Index, 3>& t, Index label) {
    mesh.triangles.push_back(t);
    mesh.faceOf.push_back(label);
  }
  void addFacing(std::array<Index, 3> t, Index label) {
    const auto point = [&](std::size_t k) { return mesh.points[static_cast<std::size_t>(t[k])]; };
    const Vec3 facing = (point(1) - point(0)).cross(point(2) - point(0));
    if (facing.dot(normal_) < 0) std::swap(t[1], t[2]);
    add(t, label);
  }

  const std::vector<std::vector<Vec3>>& surfaces_;
  Index perSurface_;
  Vec3 onPlane_;
  Vec3 normal_;
  std::map<std::pair<Index, Index>, Index> numbers_;
};

}  // namespace

TriMesh cutaway(const std::vector<std::array<Index, 3>>& triangles,
                const std::vector<std::vector<Vec3>>& surfaces, const Vec3& onPlane,
                const Vec3& normal) {
  Cutter cutter(surfaces, onPlane, normal);
  const std::size_t count = surfaces.size();
  for (std::size_t s = 0; s < count; ++s) {
    for (const auto& t : triangles) {
      const auto on = [&](std::size_t surface, std::size_t k) {
        return cutter.number(surface, t[k]);
      };
      cutter.addTriangle({on(s, 0), on(s, 1), on(s, 2)}, static_cast<Index>(s));
      if (s + 1 == count) continue;
      std::array<std::size_t, 3> k{0, 1, 2};
      std::sort(k.begin(), k.end(), [&](std::size_t a, std::size_t b) { return t[a] < t[b]; });
      const auto layer = static_cast<Index>(count + s);
      cutter.addSection({on(s, k[0]), on(s, k[1]), on(s, k[2]), on(s + 1, k[2])}, layer);
      cutter.addSection({on(s, k[0]), on(s, k[1]), on(s + 1, k[1]), on(s + 1, k[2])}, layer);
      cutter.addSection({on(s, k[0]), on(s + 1, k[0]), on(s + 1, k[1]), on(s + 1, k[2])}, layer);
    }
  }
  return std::move(cutter.mesh);
}

}  // namespace thesis
