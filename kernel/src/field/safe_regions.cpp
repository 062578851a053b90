// Regions within a tile by flooding masks of 512 bits, then united across the sides of tiles.
#include "field/safe_regions.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

#include "base/parallel.h"
#include "field/held_nodes.h"
#include "geom/mesh_topology.h"

namespace phront {
namespace {

constexpr std::size_t kLayers = DistanceField::kTileSize;
constexpr std::int64_t kGrain = 16;           // tiles per task
constexpr double kMoreThanHalf = 0.5 + 1e-9;  // of h: values are rounded

using Bits = std::array<std::uint64_t, kLayers>;  // as Tile::held

/// The part of a region that lies in one tile.
struct Patch {
  Bits bits;
  int node = -1;
  double phi = 0;
};

bool any(const Bits& bits) {
  return std::any_of(bits.begin(), bits.end(), [](std::uint64_t word) { return word != 0; });
}

/// A layer and what neighbours it within.
std::uint64_t grown(std::uint64_t layer) {
  constexpr std::uint64_t kNotFirst = 0xfefefefefefefefe;
  constexpr std::uint64_t kNotLast = 0x7f7f7f7f7f7f7f7f;
  return layer | (layer << 1 & kNotFirst) | (layer >> 1 & kNotLast) | layer << 8 | layer >> 8;
}

/// The nodes of `within` connected to the first of them.
Bits flood(const Bits& within) {
  Bits filled{};
  const auto first = static_cast<std::size_t>(
      std::find_if(within.begin(), within.end(), [](auto word) { return word != 0; }) -
      within.begin());
  filled[first] = within[first] & (~within[first] + 1);
  for (bool again = true; again;) {
    again = false;
    // Up and down in turn: a column is filled in one go.
    for (std::size_t pass = 0; pass < 2 * kLayers; ++pass) {
      const std::size_t k = pass < kLayers ? pass : 2 * kLayers - 1 - pass;
      std::uint64_t next = grown(filled[k]);
      if (k > 0) next |= filled[k - 1];
      if (k + 1 < kLayers) next |= filled[k + 1];
      next &= within[k];
      again = again || next != filled[k];
      filled[k] = next;
    }
  }
  return filled;
}

class Finder {
 public:
  Finder(const DistanceField& field, const std::vector<double>& phi, int threads)
      : field_(field),
        tiles_(field.tiles()),
        phi_(phi),
        threads_(threads),
        patches_(tiles_.size()) {}

  std::vector<SafeRegion> run() {
    parallelFor(static_cast<std::int64_t>(tiles_.size()), threads_, kGrain,
                [&](std::int64_t begin, std::int64_t end) {
                  for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end);
                       ++t) {
                    findPatches(t);
                  }
                });
    first_.reserve(tiles_.size() + 1);
    first_.push_back(0);
    for (const auto& patches : patches_)
      first_.push_back(first_.back() + static_cast<Index>(patches.size()));
    DisjointSets sets(static_cast<std::size_t>(first_.back()));
    for (std::size_t t = 0; t < tiles_.size(); ++t) {
      for (std::size_t axis = 0; axis < 3; ++axis) unite(t, axis, sets);
    }
    return collect(sets);
  }

 private:
  void findPatches(std::size_t t) {
    std::array<Bits, 2> safe{};  // positive, negative
    const double least = kMoreThanHalf * field_.spacing();
    forHeld(tiles_[t], phi_, [&](int n, double phi) {
      if (std::abs(phi) > least)
        safe[phi < 0 ? 1 : 0][static_cast<std::size_t>(n >> 6)] |= std::uint64_t{1} << (n & 63);
    });
    for (Bits& left : safe) {
      while (any(left)) {
        const Bits bits = flood(left);
        patches_[t].push_back({bits});
        for (std::size_t k = 0; k < kLayers; ++k) left[k] &= ~bits[k];
      }
    }
    forHeld(tiles_[t], phi_, [&](int n, double phi) {
      for (Patch& patch : patches_[t]) {
        const bool inside = (patch.bits[static_cast<std::size_t>(n >> 6)] >> (n & 63) & 1U) != 0;
        if (!inside || std::abs(phi) <= std::abs(patch.phi)) continue;
        patch.phi = phi;
        patch.node = n;
      }
    });
  }

  /// With the patches of the next tile along an axis.
  void unite(std::size_t t, std::size_t axis, DisjointSets& sets) const {
    GridIndex next = tiles_[t].coordinates;
    ++next[axis];
    const Index found = field_.findTile(next);
    if (found == kNone) return;
    const auto o = static_cast<std::size_t>(found);
    for (std::size_t a = 0; a < patches_[t].size(); ++a) {
      for (std::size_t b = 0; b < patches_[o].size(); ++b) {
        const Patch& mine = patches_[t][a];
        const Patch& theirs = patches_[o][b];
        if ((mine.phi < 0) == (theirs.phi < 0) && touch(mine.bits, theirs.bits, axis))
          sets.unite(first_[t] + static_cast<Index>(a), first_[o] + static_cast<Index>(b));
      }
    }
  }

  /// Does the last layer along an axis have nodes in common with the first one of the next tile?
  static bool touch(const Bits& a, const Bits& b, std::size_t axis) {
    if (axis == 2) return (a.back() & b.front()) != 0;
    const int shift = axis == 0 ? 7 : 56;
    const std::uint64_t firstLayer = axis == 0 ? 0x0101010101010101 : 0xff;
    for (std::size_t k = 0; k < kLayers; ++k) {
      if ((a[k] >> shift & b[k] & firstLayer) != 0) return true;
    }
    return false;
  }

  std::vector<SafeRegion> collect(DisjointSets& sets) const {
    std::vector<SafeRegion> regions;
    std::vector<Index> regionOf(static_cast<std::size_t>(first_.back()), kNone);
    for (std::size_t t = 0; t < tiles_.size(); ++t) {
      for (std::size_t a = 0; a < patches_[t].size(); ++a) {
        const Patch& patch = patches_[t][a];
        Index& number =
            regionOf[static_cast<std::size_t>(sets.find(first_[t] + static_cast<Index>(a)))];
        if (number == kNone) {
          number = static_cast<Index>(regions.size());
          regions.emplace_back();
        }
        SafeRegion& region = regions[static_cast<std::size_t>(number)];
        if (region.tiles.empty() || region.tiles.back() != static_cast<Index>(t))
          region.tiles.push_back(static_cast<Index>(t));
        if (std::abs(patch.phi) <= std::abs(region.phi)) continue;
        region.tile = static_cast<Index>(t);
        region.node = patch.node;
        region.phi = patch.phi;
      }
    }
    return regions;
  }

  const DistanceField& field_;
  const std::vector<DistanceField::Tile>& tiles_;
  const std::vector<double>& phi_;
  int threads_;
  std::vector<std::vector<Patch>> patches_;
  std::vector<Index> first_;  ///< number of each tile's first patch
};

}  // namespace

std::vector<SafeRegion> safeRegions(const DistanceField& field, const std::vector<double>& phi,
                                    int threads) {
  return Finder(field, phi, threads).run();
}

}  // namespace phront
