// The sign of a node is that of its foot's pseudonormal, a local matter. Two checks make it global:
// neighbours of opposite sign must both be near the surface, |phi_i| + |phi_j| <= h, as phi is
// 1-Lipschitz; and in every tile the node farthest from the surface must agree with the winding
// number (Jacobson et al. 2013). A tile that fails either gets all its signs from the winding
// number, then its neighbours are checked against it, until nothing fails any more. The region
// where the winding number exceeds one half is bounded by the surface, so the end is consistent.
// Weak spot: on a surface that intersects itself the magnitude stays the distance to the nearest
// sheet, inner sheets included.
#include "field/sign_audit.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace phront {

namespace {

constexpr int kSize = DistanceField::kTileSize;
constexpr double kSlack = 1 + 1e-9;  // on h: feet are rounded
constexpr std::int64_t kGrain = 16;  // tiles per task

using Tile = DistanceField::Tile;

std::size_t at(int i, int j, int k) {
  return static_cast<std::size_t>((k * kSize + j) * kSize + i);
}

class Auditor {
 public:
  Auditor(const SurfaceDistance& surface, const DistanceField& grid, std::vector<Tile>& tiles,
          int threads)
      : surface_(surface), grid_(grid), tiles_(tiles), threads_(threads) {
    // Inward oriented: the surface bounds a void in unbounded material, whose number is one more.
    threshold_ = signedVolume(surface.mesh()) >= 0 ? 0.5 : -0.5;
  }

  std::int64_t run() {
    std::vector<char> suspect(tiles_.size(), 0);
    forAll([&](std::size_t t) { suspect[t] = !agreesWithWinding(t) || contradicts(t) ? 1 : 0; });
    std::vector<char> done(tiles_.size(), 0);
    std::vector<std::int64_t> turned(tiles_.size(), 0);
    while (std::find(suspect.begin(), suspect.end(), 1) != suspect.end()) {
      forAll([&](std::size_t t) {
        if (suspect[t] == 0) return;
        turned[t] = resign(tiles_[t]);
        done[t] = 1;
      });
      forAll([&](std::size_t t) { suspect[t] = done[t] == 0 && contradicts(t) ? 1 : 0; });
    }
    std::int64_t sum = 0;
    for (const std::int64_t n : turned) sum += n;
    return sum;
  }

 private:
  template <class Body>
  void forAll(Body&& body) {
    parallelFor(static_cast<std::int64_t>(tiles_.size()), threads_, kGrain,
                [&](std::int64_t begin, std::int64_t end) {
                  for (std::int64_t t = begin; t < end; ++t) body(static_cast<std::size_t>(t));
                });
  }

  Vec3 position(const Tile& tile, std::size_t n) const {
    const auto number = static_cast<int>(n);
    return grid_.position({tile.coordinates[0] * kSize + number % kSize,
                           tile.coordinates[1] * kSize + number / kSize % kSize,
                           tile.coordinates[2] * kSize + number / (kSize * kSize)});
  }

  bool inMaterial(const Vec3& x) const { return surface_.windingNumber(x) > threshold_; }

  bool agreesWithWinding(std::size_t t) const {
    const Tile& tile = tiles_[t];
    const auto farthest =
        std::max_element(tile.phi.begin(), tile.phi.end(),
                         [](double a, double b) { return std::abs(a) < std::abs(b); });
    const auto n = static_cast<std::size_t>(farthest - tile.phi.begin());
    return (*farthest < 0) == inMaterial(position(tile, n));
  }

  bool clash(double a, double b) const {
    return (a < 0) != (b < 0) && std::abs(a - b) > grid_.spacing() * kSlack;
  }

  // Looks at all pairs inside the tile and at those across its six sides.
  bool contradicts(std::size_t t) const {
    const Tile& tile = tiles_[t];
    for (int k = 0; k < kSize; ++k) {
      for (int j = 0; j < kSize; ++j) {
        for (int i = 0; i < kSize; ++i) {
          const double phi = tile.phi[at(i, j, k)];
          if (i + 1 < kSize && clash(phi, tile.phi[at(i + 1, j, k)])) return true;
          if (j + 1 < kSize && clash(phi, tile.phi[at(i, j + 1, k)])) return true;
          if (k + 1 < kSize && clash(phi, tile.phi[at(i, j, k + 1)])) return true;
        }
      }
    }
    for (int side = 0; side < 6; ++side) {
      GridIndex next = tile.coordinates;
      const auto axis = static_cast<std::size_t>(side / 2);
      const bool up = side % 2 == 1;
      next[axis] += up ? 1 : -1;
      const Index other = grid_.findTile(next);
      if (other == kNone) continue;
      if (clashAcross(tile, tiles_[static_cast<std::size_t>(other)], side / 2, up)) return true;
    }
    return false;
  }

  bool clashAcross(const Tile& tile, const Tile& other, int axis, bool up) const {
    for (int a = 0; a < kSize; ++a) {
      for (int b = 0; b < kSize; ++b) {
        std::array<int, 3> mine{a, b, 0};
        std::swap(mine[2], mine[static_cast<std::size_t>(axis)]);
        std::array<int, 3> theirs = mine;
        mine[static_cast<std::size_t>(axis)] = up ? kSize - 1 : 0;
        theirs[static_cast<std::size_t>(axis)] = up ? 0 : kSize - 1;
        if (clash(tile.phi[at(mine[0], mine[1], mine[2])],
                  other.phi[at(theirs[0], theirs[1], theirs[2])])) {
          return true;
        }
      }
    }
    return false;
  }

  std::int64_t resign(Tile& tile) const {
    std::int64_t turned = 0;
    for (std::size_t n = 0; n < tile.phi.size(); ++n) {
      if (tile.phi[n] == 0) continue;
      const double phi = std::abs(tile.phi[n]) * (inMaterial(position(tile, n)) ? -1 : 1);
      turned += phi != tile.phi[n] ? 1 : 0;
      tile.phi[n] = phi;
    }
    return turned;
  }

  const SurfaceDistance& surface_;
  const DistanceField& grid_;
  std::vector<Tile>& tiles_;
  int threads_;
  double threshold_ = 0.5;
};

}  // namespace

std::int64_t auditSigns(const SurfaceDistance& surface, const DistanceField& grid,
                        std::vector<DistanceField::Tile>& tiles, int threads) {
  return Auditor(surface, grid, tiles, threads).run();
}

}  // namespace phront
