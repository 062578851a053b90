// Signed distance on sparse tiles of a Cartesian grid.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "phront/progress.h"
#include "phront/status.h"
#include "phront/surface_distance.h"

namespace phront {

/// Integer coordinates of a grid node or tile.
using GridIndex = std::array<std::int32_t, 3>;

/// Which nodes a field must hold and how fine.
struct FieldOptions {
  double spacing = 0;  ///< h > 0, model units
  double bandMin = 0;  ///< nodes with bandMin <= phi <= bandMax are held for certain
  double bandMax = 0;  ///< (whole tiles are: more nodes than asked)
  int threads = 0;     ///< 0: all cores
  std::int64_t maxNodes = 400'000'000;  ///< refuse beyond (ResourceLimit) instead of swapping
  /// Position of node (0,0,0); automatic: lower corner of the surface's box.
  std::optional<Vec3> origin = std::nullopt;
};

class FieldBuilder;

/// phi on 8x8x8-node tiles, allocated only where the band needs them. Node (i,j,k) lies at
/// origin + h (i,j,k); tile (a,b,c) holds nodes 8a..8a+7 and so on. Same input, same bits at any
/// thread count. Off the band `phi` is absent, never guessed.
class DistanceField {
 public:
  static constexpr int kTileSize = 8;
  static constexpr int kNodesPerTile = kTileSize * kTileSize * kTileSize;

  struct Tile {
    GridIndex coordinates{};                      ///< tile coordinates
    std::array<double, kNodesPerTile> phi{};      ///< x fastest, then y, then z; signed
    std::array<Index, kNodesPerTile> triangle{};  ///< closest triangle, kNone beyond the border
  };

  [[nodiscard]] double spacing() const { return spacing_; }
  [[nodiscard]] const Vec3& origin() const { return origin_; }
  [[nodiscard]] const std::vector<Tile>& tiles() const {
    return tiles_;
  }  ///< sorted by coordinates

  [[nodiscard]] Vec3 position(const GridIndex& node) const {
    return origin_ + spacing_ * Vec3(node[0], node[1], node[2]);
  }
  /// Nodes whose sign was taken from the winding number because signs of neighbours contradicted
  /// each other (closed surfaces that intersect themselves); 0 for a sound mesh.
  [[nodiscard]] std::int64_t signRepairs() const { return signRepairs_; }

  /// Number (into tiles()) of the tile with these tile coordinates, or kNone.
  [[nodiscard]] Index findTile(const GridIndex& tile) const;
  /// phi at a node; empty where no tile is or where the node lies beyond an open border.
  [[nodiscard]] std::optional<double> phi(const GridIndex& node) const;
  /// Trilinear phi at a point; empty when one of the eight nodes is absent. Error O(h^2), O(h) at
  /// kinks.
  [[nodiscard]] std::optional<double> interpolate(const Vec3& x) const;

 private:
  friend class FieldBuilder;
  double spacing_ = 0;
  Vec3 origin_ = Vec3::Zero();
  std::vector<Tile> tiles_;
  std::vector<GridIndex> keys_;  ///< coordinates of tiles_, packed for the search
  std::int64_t signRepairs_ = 0;
};

/// Exact signed distance (to the mesh) on all tiles that meet the band: one exact
/// query per node, bounded by its neighbour's triangle; sign by topology. Error: round-off. Beyond
/// the border of an open shell a tile's phi is the distance with the sign of the carried face, its
/// triangle kNone. Fails with InvalidArgument (h <= 0, band empty or NaN), ResourceLimit,
/// Cancelled.
[[nodiscard]] Result<DistanceField> solveDistanceField(const SurfaceDistance& surface,
                                                       const FieldOptions& options,
                                                       const Progress& progress = {});

}  // namespace phront
