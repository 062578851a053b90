// A field as VTU: the hexahedra whose eight nodes all have phi, with phi and the closest triangle
// as point data. Nodes are in the order of the tiles; nodes without phi are left out.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <new>

#include "io/vtu.h"
#include "phront/mesh_io.h"

namespace phront {
namespace {

constexpr std::uint8_t kVtkHexahedron = 12;
constexpr int kSize = DistanceField::kTileSize;

int nodeInTile(int i, int j, int k) { return i + kSize * (j + kSize * k); }

/// Number of each node among those written, per tile; kNone for the others.
using NodeNumbers = std::vector<std::array<Index, DistanceField::kNodesPerTile>>;

/// Cells whose lowest node lies in tile `t`. Corners may lie in the seven tiles above it.
void appendCells(const DistanceField& field, const NodeNumbers& numbers, std::size_t t,
                 std::vector<std::int32_t>& connectivity) {
  std::array<Index, 8> tileAt{};
  for (int corner = 0; corner < 8; ++corner) {
    GridIndex c = field.tiles()[t].coordinates;
    for (int axis = 0; axis < 3; ++axis) c[static_cast<std::size_t>(axis)] += (corner >> axis) & 1;
    tileAt[static_cast<std::size_t>(corner)] = field.findTile(c);
  }
  const auto number = [&](int i, int j, int k) -> Index {
    const int corner = (i / kSize) | (j / kSize) << 1 | (k / kSize) << 2;
    const Index tile = tileAt[static_cast<std::size_t>(corner)];
    if (tile == kNone) return kNone;
    return numbers[static_cast<std::size_t>(tile)]
                  [static_cast<std::size_t>(nodeInTile(i % kSize, j % kSize, k % kSize))];
  };
  for (int k = 0; k < kSize; ++k) {
    for (int j = 0; j < kSize; ++j) {
      for (int i = 0; i < kSize; ++i) {
        const std::array<Index, 8> hexahedron{number(i, j, k),
                                              number(i + 1, j, k),
                                              number(i + 1, j + 1, k),
                                              number(i, j + 1, k),
                                              number(i, j, k + 1),
                                              number(i + 1, j, k + 1),
                                              number(i + 1, j + 1, k + 1),
                                              number(i, j + 1, k + 1)};
        bool complete = true;
        for (const Index n : hexahedron) complete = complete && n != kNone;
        if (complete) connectivity.insert(connectivity.end(), hexahedron.begin(), hexahedron.end());
      }
    }
  }
}

std::string formatField(const DistanceField& field) {
  NodeNumbers numbers(field.tiles().size());
  std::vector<double> coordinates;
  std::vector<double> phi;
  std::vector<std::int32_t> triangle;
  for (std::size_t t = 0; t < field.tiles().size(); ++t) {
    const DistanceField::Tile& tile = field.tiles()[t];
    for (int node = 0; node < DistanceField::kNodesPerTile; ++node) {
      Index& number = numbers[t][static_cast<std::size_t>(node)];
      number = kNone;
      const std::int64_t slot = tile.slot(node);
      if (slot < 0 || field.triangles()[static_cast<std::size_t>(slot)] == kNone) continue;
      number = static_cast<Index>(phi.size());
      const Vec3 p = field.position(field.node(tile, node));
      coordinates.insert(coordinates.end(), {p.x(), p.y(), p.z()});
      phi.push_back(field.values()[static_cast<std::size_t>(slot)]);
      triangle.push_back(field.triangles()[static_cast<std::size_t>(slot)]);
    }
  }
  io::Cells cells{.connectivity = {}, .type = kVtkHexahedron, .corners = 8};
  for (std::size_t t = 0; t < field.tiles().size(); ++t) {
    appendCells(field, numbers, t, cells.connectivity);
  }
  io::VtuPiece piece;
  const std::string pointData =
      piece.add("phi", "Float64", 1, phi) + piece.add("triangle", "Int32", 1, triangle);
  return io::assembleVtu(piece, coordinates, cells, pointData, {});
}

}  // namespace

Result<void> writeField(const DistanceField& field, const std::filesystem::path& path) try {
  const auto kind = meshFormatOf(path);
  if (!kind) return tl::unexpected(kind.error());
  if (*kind != MeshFormat::Vtu) {
    return fail(ErrorCode::InvalidArgument,
                fmt::format("{}: fields are written as .vtu", path.string()));
  }
  return writeFileAtomically(path, formatField(field));
} catch (const std::bad_alloc&) {
  return fail(ErrorCode::ResourceLimit,
              fmt::format("cannot write {}: out of memory", path.string()));
}

}  // namespace phront
