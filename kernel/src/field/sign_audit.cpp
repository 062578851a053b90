// The sign of a node is that of its foot's pseudonormal, a local matter. Two checks make it global:
// neighbours of opposite sign must both be near the surface, |phi_i| + |phi_j| <= h, as phi is
// 1-Lipschitz; and the winding number (Jacobson et al. 2013) must agree at one node of every region
// that lies on one side, and in tiles that hold nothing of a region. A tile that fails either gets
// all its signs from the winding number, then its neighbours are checked against it, until nothing
// fails any more. The part of space where the winding number exceeds one half is bounded by the
// surface, so the end is consistent.
// Weak spot: on a surface that intersects itself the magnitude stays the distance to the nearest
// sheet, inner sheets included.
#include "field/sign_audit.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/parallel.h"
#include "field/held_nodes.h"
#include "field/safe_regions.h"

namespace phront {

namespace {

constexpr int kSize = DistanceField::kTileSize;
constexpr int kBits = 3;             // kSize == 1 << kBits
constexpr double kSlack = 1 + 1e-9;  // on h: feet are rounded
constexpr std::int64_t kGrain = 16;  // tiles per task

using Tile = DistanceField::Tile;

class Auditor {
 public:
  Auditor(const SurfaceDistance& surface, const DistanceField& field, std::vector<double>& phi,
          int threads)
      : surface_(surface),
        field_(field),
        tiles_(field.tiles()),
        phi_(phi),
        negative_(tiles_.size()),
        threads_(threads) {
    // Inward oriented: the surface bounds a void in unbounded material, whose number is one more.
    threshold_ = signedVolume(surface.mesh()) >= 0 ? 0.5 : -0.5;
  }

  std::int64_t run() {
    forAll([&](std::size_t t) { readSigns(t); });
    std::vector<char> suspect(tiles_.size(), 0);
    std::vector<char> checked(tiles_.size(), 0);
    for (const SafeRegion& region : safeRegions(field_, phi_, threads_)) {
      const bool right =
          agreesWithWinding(tiles_[static_cast<std::size_t>(region.tile)], region.node, region.phi);
      for (const Index t : region.tiles) {
        checked[static_cast<std::size_t>(t)] = 1;
        if (!right) suspect[static_cast<std::size_t>(t)] = 1;
      }
    }
    forAll([&](std::size_t t) {
      if (contradicts(t) || (checked[t] == 0 && !farthestAgrees(t))) suspect[t] = 1;
    });
    std::vector<char> done(tiles_.size(), 0);
    std::vector<std::int64_t> turned(tiles_.size(), 0);
    while (std::find(suspect.begin(), suspect.end(), 1) != suspect.end()) {
      forAll([&](std::size_t t) {
        if (suspect[t] == 0) return;
        turned[t] = resign(t);
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

  using Bits = std::array<std::uint64_t, 8>;  // as Tile::held

  void readSigns(std::size_t t) {
    Bits& bits = negative_[t];
    bits = {};
    forHeld(tiles_[t], phi_, [&](int n, double phi) {
      if (phi < 0) bits[static_cast<std::size_t>(n >> 6)] |= std::uint64_t{1} << (n & 63);
    });
  }

  bool inMaterial(const Vec3& x) const { return surface_.timesAround(x) > threshold_; }

  bool agreesWithWinding(const Tile& tile, int node, double phi) const {
    return (phi < 0) == inMaterial(field_.position(field_.node(tile, node)));
  }

  bool farthestAgrees(std::size_t t) const {
    double farthest = 0;
    int node = -1;
    forHeld(tiles_[t], phi_, [&](int n, double phi) {
      if (node >= 0 && std::abs(phi) <= std::abs(farthest)) return;
      farthest = phi;
      node = n;
    });
    return node < 0 || agreesWithWinding(tiles_[t], node, farthest);
  }

  // Looks at all pairs inside the tile and at those across its six sides.
  bool contradicts(std::size_t t) const {
    constexpr std::uint64_t kNotLastInRow = 0x7f7f7f7f7f7f7f7f;
    constexpr std::uint64_t kNotLastRow = 0x00ffffffffffffff;
    const Tile& tile = tiles_[t];
    const Bits& held = tile.held;
    const Bits& negative = negative_[t];
    for (std::size_t k = 0; k < held.size(); ++k) {
      const auto node = static_cast<int>(64 * k);
      const std::uint64_t h = held[k];
      const std::uint64_t s = negative[k];
      if (clash(tile, node, tile, node + 1, h & (h >> 1) & (s ^ (s >> 1)) & kNotLastInRow) ||
          clash(tile, node, tile, node + 8, h & (h >> 8) & (s ^ (s >> 8)) & kNotLastRow)) {
        return true;
      }
      if (k + 1 < held.size() &&
          clash(tile, node, tile, node + 64, h & held[k + 1] & (s ^ negative[k + 1]))) {
        return true;
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      for (const bool up : {false, true}) {
        if (clashAcross(t, axis, up)) return true;
      }
    }
    return false;
  }

  bool clashAcross(std::size_t t, int axis, bool up) const {
    GridIndex next = tiles_[t].coordinates;
    next[static_cast<std::size_t>(axis)] += up ? 1 : -1;
    const Index found = field_.findTile(next);
    if (found == kNone) return false;
    const auto o = static_cast<std::size_t>(found);
    constexpr std::array<std::uint64_t, 3> kFirstLayer{0x0101010101010101, 0xff, ~0ULL};
    const std::uint64_t layer = kFirstLayer[static_cast<std::size_t>(axis)];
    const int shift = axis == 2 ? 0 : (kSize - 1) << (kBits * axis);  // from first layer to last
    const int mine = up ? shift : 0;
    const int theirs = shift - mine;
    for (std::size_t k = 0; k < (axis == 2 ? 1U : 8U); ++k) {
      const std::size_t a = axis == 2 && up ? kSize - 1 : k;
      const std::size_t b = axis == 2 && !up ? kSize - 1 : k;
      const std::uint64_t both = (tiles_[t].held[a] >> mine) & (tiles_[o].held[b] >> theirs);
      const std::uint64_t opposite = (negative_[t][a] >> mine) ^ (negative_[o][b] >> theirs);
      if (clash(tiles_[t], static_cast<int>(64 * a) + mine, tiles_[o],
                static_cast<int>(64 * b) + theirs, both & opposite & layer)) {
        return true;
      }
    }
    return false;
  }

  /// Nodes of opposite sign, n from the first ones for each bit n, that are farther apart in phi
  /// than one spacing?
  bool clash(const Tile& a, int firstOfA, const Tile& b, int firstOfB,
             std::uint64_t opposite) const {
    for (; opposite != 0; opposite &= opposite - 1) {
      const int n = std::countr_zero(opposite);
      const double phiA = phi_[static_cast<std::size_t>(a.slot(firstOfA + n))];
      const double phiB = phi_[static_cast<std::size_t>(b.slot(firstOfB + n))];
      if (std::abs(phiA - phiB) > field_.spacing() * kSlack) return true;
    }
    return false;
  }

  std::int64_t resign(std::size_t t) {
    std::int64_t turned = 0;
    const Tile& tile = tiles_[t];
    forHeld(tile, phi_, [&](int n, double& phi) {
      if (phi == 0) return;
      const double side = inMaterial(field_.position(field_.node(tile, n))) ? -1 : 1;
      turned += side * phi < 0 ? 1 : 0;
      phi = std::copysign(phi, side);
    });
    readSigns(t);
    return turned;
  }

  const SurfaceDistance& surface_;
  const DistanceField& field_;
  const std::vector<Tile>& tiles_;
  std::vector<double>& phi_;
  std::vector<Bits> negative_;
  int threads_;
  double threshold_ = 0.5;
};

}  // namespace

std::int64_t auditSigns(const SurfaceDistance& surface, const DistanceField& field,
                        std::vector<double>& phi, int threads) {
  return Auditor(surface, field, phi, threads).run();
}

}  // namespace phront
