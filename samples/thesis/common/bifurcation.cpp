// Three tapered tubes from one point, blended. Each is a stack of rings between its end and the
// place where it meets the others. There its ring is made of two arcs, one for each of the others,
// and all three arcs run from the same point in front to the same point behind: neighbours share
// the points of their arc, so the whole is one mesh. Points are shot onto the wall from the tube's
// axis.
#include "common/bifurcation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace thesis {
namespace {

using phront::Index;
using phront::TriMesh;
using phront::Vec3;

struct Tube {
  Vec3 end;  // of the axis, which starts at the origin
  double firstRadius;
  double lastRadius;
};
// Common, internal and external carotid artery: proportions of adults, rounded.
const std::array<Tube, 3> kTubes{Tube{{0, 0, -14}, 3.1, 3.1}, Tube{{8, 0, 14}, 2.8, 2.3},
                                 Tube{{-7, 0, 12}, 2, 1.7}};
constexpr double kBlend = 1;   // mm that a tube feels of the others: how round the crotch is
constexpr double kReach = 20;  // mm: no point of the wall is farther from an axis
const Vec3 kHub{0, 0, 2.5};    // inside, about as far from the crotch as from the walls beside it
const Vec3 kFront = -Vec3::UnitY();

/// < 0 in the blood. The blend adds to the radius where tubes meet: the bulb of the artery.
double wall(const Vec3& x) {
  double sum = 0;
  for (const Tube& tube : kTubes) {
    const double along = std::clamp(x.dot(tube.end) / tube.end.squaredNorm(), 0.0, 1.5);
    const double radius = tube.firstRadius + along * (tube.lastRadius - tube.firstRadius);
    sum += std::exp((radius - (x - along * tube.end).norm()) / kBlend);
  }
  return -kBlend * std::log(sum);
}

/// Where a ray from inside meets the wall first.
Vec3 shoot(const Vec3& from, const Vec3& direction) {
  double low = 0;
  double high = 0;
  while (high < kReach && wall(from + high * direction) < 0) {
    low = high;
    high += kBlend / 4;
  }
  while (high - low > 1e-12 * kReach) {
    const double middle = (low + high) / 2;
    (wall(from + middle * direction) < 0 ? low : high) = middle;
  }
  return from + (low + high) / 2 * direction;
}

class Builder {
 public:
  explicit Builder(int around) : around_(around) {
    front_ = add(shoot(kHub, kFront));
    back_ = add(shoot(kHub, -kFront));
    for (std::size_t i = 0; i < 3; ++i) arcs_[i] = arcBetween(kTubes[i], kTubes[(i + 1) % 3]);
    for (std::size_t i = 0; i < 3; ++i) {
      // Down the arc with the next tube, up the one with the tube before.
      std::vector<Index> ring = arcs_[i];
      ring.insert(ring.end(), arcs_[(i + 2) % 3].rbegin() + 1, arcs_[(i + 2) % 3].rend() - 1);
      addTube(kTubes[i], std::move(ring));
    }
  }

  TriMesh mesh;

 private:
  Index add(const Vec3& x) {
    mesh.points.push_back(x);
    return static_cast<Index>(mesh.points.size()) - 1;
  }
  [[nodiscard]] const Vec3& at(Index i) const { return mesh.points[static_cast<std::size_t>(i)]; }

  /// Points at equal distances along the wall between two tubes.
  std::vector<Index> arcBetween(const Tube& a, const Tube& b) {
    constexpr int kFine = 40;  // shots per point of the arc
    const int parts = around_ / 2;
    const Vec3 side = (a.end.normalized() + b.end.normalized()).normalized();
    std::vector<Vec3> line;
    std::vector<double> length{0};
    for (int k = 0; k <= kFine * parts; ++k) {
      const double angle = std::numbers::pi * k / (kFine * parts);
      line.push_back(shoot(kHub, std::cos(angle) * kFront + std::sin(angle) * side));
      if (k > 0) length.push_back(length.back() + (line.back() - line[line.size() - 2]).norm());
    }
    std::vector<Index> arc{front_};
    for (int k = 1; k < parts; ++k) {
      const auto nearest =
          std::lower_bound(length.begin(), length.end(), length.back() * k / parts);
      arc.push_back(add(line[static_cast<std::size_t>(nearest - length.begin())]));
    }
    arc.push_back(back_);
    return arc;
  }

  void addTube(const Tube& tube, std::vector<Index> ring) {
    const Vec3 axis = tube.end.normalized();
    const std::vector<Index> first = ring;
    const Vec3 side = axis.cross(kFront).normalized() *
                      (at(first[first.size() / 4]).dot(axis.cross(kFront)) > 0 ? 1 : -1);
    const double spacing = 2 * std::numbers::pi * tube.lastRadius / around_;
    const int rings = static_cast<int>(std::ceil(tube.end.norm() / spacing));
    for (int r = 1; r <= rings; ++r) {
      const double share = static_cast<double>(r) / rings;
      std::vector<Index> next;
      for (int k = 0; k < around_; ++k) {
        const double angle = 2 * std::numbers::pi * k / around_;
        const Vec3 last =
            tube.end + tube.lastRadius * (std::cos(angle) * kFront + std::sin(angle) * side);
        const Vec3 x = (1 - share) * at(first[static_cast<std::size_t>(k)]) + share * last;
        const Vec3 from = x.dot(axis) * axis;
        next.push_back(add(shoot(from, (x - from).normalized())));
      }
      addBand(ring, next, axis);
      ring = std::move(next);
    }
  }

  void addBand(const std::vector<Index>& from, const std::vector<Index>& to, const Vec3& axis) {
    for (std::size_t k = 0; k < from.size(); ++k) {
      const std::size_t l = (k + 1) % from.size();
      const std::array<Index, 4> q{from[k], from[l], to[l], to[k]};
      // The shorter diagonal.
      if ((at(q[0]) - at(q[2])).norm() < (at(q[1]) - at(q[3])).norm()) {
        addOutward({q[0], q[1], q[2]}, axis);
        addOutward({q[0], q[2], q[3]}, axis);
      } else {
        addOutward({q[0], q[1], q[3]}, axis);
        addOutward({q[1], q[2], q[3]}, axis);
      }
    }
  }

  void addOutward(std::array<Index, 3> t, const Vec3& axis) {
    const Vec3& p = at(t[0]);
    const Vec3 normal = (at(t[1]) - p).cross(at(t[2]) - p);
    if (normal.dot(p - p.dot(axis) * axis) < 0) std::swap(t[1], t[2]);
    mesh.triangles.push_back(t);
  }

  int around_;
  Index front_;
  Index back_;
  std::array<std::vector<Index>, 3> arcs_;
};

}  // namespace

TriMesh bifurcation(int around) { return Builder(around).mesh; }

}  // namespace thesis
