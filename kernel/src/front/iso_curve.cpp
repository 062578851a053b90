#include "phront/iso_curve.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace phront {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Corners of a cell counter-clockwise from the lower left; side k runs from corner k to k + 1.
constexpr std::array<std::array<std::int32_t, 2>, 4> kCorner{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

class Marcher {
 public:
  Marcher(const NodeGrid& grid, std::span<const double> values, double level)
      : grid_(grid), values_(values), level_(level) {
    const auto count = static_cast<std::size_t>(grid.nodeCount());
    pointOf_[0].assign(count, kNone);
    pointOf_[1].assign(count, kNone);
  }

  CurveMesh march() {
    for (std::int32_t j = 0; j + 1 < grid_.nodes[1]; ++j) {
      for (std::int32_t i = 0; i + 1 < grid_.nodes[0]; ++i) cell(i, j);
    }
    numberCurves();
    return std::move(mesh_);
  }

 private:
  void cell(std::int32_t i, std::int32_t j) {
    std::array<double, 4> v;
    unsigned below = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      v[k] = values_[static_cast<std::size_t>(grid_.number(i + kCorner[k][0], j + kCorner[k][1]))];
      if (v[k] == std::numeric_limits<double>::infinity()) return;
      if (v[k] < level_) below |= 1U << k;
    }
    // The line enters over a side that goes from below to above (counter-clockwise) and leaves over
    // one that goes back, with the corners below on its left.
    std::array<std::size_t, 2> up{};
    std::array<std::size_t, 2> down{};
    std::size_t lines = 0;
    std::size_t downs = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const bool here = (below >> k & 1U) != 0;
      const bool next = (below >> ((k + 1) % 4) & 1U) != 0;
      if (here && !next) up[lines++] = k;
      if (!here && next) down[downs++] = k;
    }
    if (lines == 2) {
      // Two opposite corners below: the saddle says whether they are connected. Lines cut off the
      // corners above when they are, the corners below when they are not.
      const double saddle = (v[0] * v[2] - v[1] * v[3]) / (v[0] + v[2] - v[1] - v[3]);
      const bool connected = saddle < level_;
      // Side k and side k + 1 share corner k + 1; side up[n] has its corner above at its end.
      if (connected != (down[0] == (up[0] + 1) % 4)) std::swap(down[0], down[1]);
    }
    for (std::size_t n = 0; n < lines; ++n) {
      mesh_.segments.push_back({point(i, j, up[n]), point(i, j, down[n])});
    }
  }

  /// The point of the level on a side of a cell, shared with the cell across.
  Index point(std::int32_t i, std::int32_t j, std::size_t side) {
    const std::size_t axis = side % 2;  // sides 0 and 2 run along x
    const std::int32_t a = i + (side == 1 ? 1 : 0);
    const std::int32_t b = j + (side == 2 ? 1 : 0);
    const std::int64_t low = grid_.number(a, b);
    const std::int64_t high = axis == 0 ? grid_.number(a + 1, b) : grid_.number(a, b + 1);
    Index& index = pointOf_[axis][static_cast<std::size_t>(low)];
    if (index != kNone) return index;
    const double from = values_[static_cast<std::size_t>(low)];
    const double to = values_[static_cast<std::size_t>(high)];
    Vec2 p = grid_.position(a, b).head<2>();
    p[static_cast<Eigen::Index>(axis)] += grid_.spacing * (level_ - from) / (to - from);
    index = static_cast<Index>(mesh_.points.size());
    mesh_.points.push_back(p);
    return index;
  }

  void numberCurves() {
    std::vector<Index> leaving(mesh_.points.size(), kNone);
    std::vector<Index> arriving(mesh_.points.size(), kNone);
    for (std::size_t s = 0; s < mesh_.segments.size(); ++s) {
      leaving[at(mesh_.segments[s][0])] = static_cast<Index>(s);
      arriving[at(mesh_.segments[s][1])] = static_cast<Index>(s);
    }
    mesh_.curveOf.assign(mesh_.segments.size(), kNone);
    Index curves = 0;
    for (std::size_t s = 0; s < mesh_.segments.size(); ++s) {
      if (mesh_.curveOf[s] != kNone) continue;
      for (Index n = static_cast<Index>(s); n != kNone && mesh_.curveOf[at(n)] == kNone;
           n = leaving[at(mesh_.segments[at(n)][1])]) {
        mesh_.curveOf[at(n)] = curves;
      }
      for (Index n = arriving[at(mesh_.segments[s][0])];
           n != kNone && mesh_.curveOf[at(n)] == kNone;
           n = arriving[at(mesh_.segments[at(n)][0])]) {
        mesh_.curveOf[at(n)] = curves;
      }
      ++curves;
    }
  }

  const NodeGrid& grid_;
  std::span<const double> values_;
  double level_;
  CurveMesh mesh_;
  std::array<std::vector<Index>, 2> pointOf_;  // per axis, of the side that starts at a node
};

}  // namespace

Result<CurveMesh> isoCurve(const NodeGrid& grid, std::span<const double> values, double level) {
  if (auto ok = checkGrid(grid); !ok) return tl::unexpected(ok.error());
  if (!grid.planar()) {
    return fail(ErrorCode::InvalidArgument, "Level lines need a grid in the plane.", "grid");
  }
  if (values.size() != static_cast<std::size_t>(grid.nodeCount())) {
    return fail(ErrorCode::InvalidArgument, "There must be one value per node.", "values");
  }
  for (const double value : values) {
    if (std::isnan(value)) return fail(ErrorCode::InvalidArgument, "A value is NaN.", "values");
  }
  if (!std::isfinite(level)) {
    return fail(ErrorCode::InvalidArgument, "The level must be finite.", "level");
  }
  return Marcher(grid, values, level).march();
}

}  // namespace phront
